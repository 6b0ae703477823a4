#include "effects/added_mass.h"

#include <glog/logging.h>

#include <algorithm>

#include "effects/free_fall.h"

namespace lacuna {

void AddedMass::SetParameters(const Eigen::VectorXd& values) {
  CHECK_EQ(values.size(), static_cast<Eigen::Index>(Card().parameters.size()));
  parameters_ = values;
  mass_.SetSettings(values.tail(values.size() - 1));
}

std::shared_ptr<const Eigen::VectorXd> AddedMass::Mass(const Body& body) const {
  return mass_.Of(body, [this](const Body& at_rest, const Eigen::VectorXd& /*settings*/) {
    return MassPerUnit(at_rest);
  });
}

double AddedMass::Size(const Body&) const { return parameters_[0]; }

Eigen::VectorXd AddedMass::MassPerUnitDerivative(const Body&, int, const Eigen::VectorXd&) const {
  LOG(FATAL) << "all other parameters of this effect are settings";
}

void AddedMass::AddScaledForce(const Kinematics& at, double size, const Eigen::VectorXd& mass,
                               Eigen::VectorXd* force) const {
  for (int i = 0; i < at.body.NodeCount(); ++i)
    force->segment<3>(3 * i) += size * mass[i] * (Gravity() - at.acceleration.segment<3>(3 * i));
}

void AddedMass::AddForce(const Kinematics& at, Eigen::VectorXd* force) const {
  AddScaledForce(at, Size(at.body), *Mass(at.body), force);
}

void AddedMass::AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                            BlockMatrix* tangent) const {
  const auto mass = Mass(at.body);
  for (int i = 0; i < at.body.NodeCount(); ++i) {
    const double added = Size(at.body) * (*mass)[i];
    tangent->Block(tangent->pattern().diagonal[i]).diagonal().array() -=
        weights.acceleration * (convexify ? std::max(added, 0.0) : added);
  }
}

void AddedMass::AddParameterDerivative(const Kinematics& at, int parameter,
                                       Eigen::VectorXd* derivative) const {
  const auto mass = Mass(at.body);
  if (parameter == 0) {
    AddScaledForce(at, 1, *mass, derivative);
  } else {
    AddScaledForce(at, Size(at.body), MassPerUnitDerivative(at.body, parameter, *mass), derivative);
  }
}

std::optional<double> AddedMass::Energy(const Kinematics& at) const {
  if (at.has_inertia) return std::nullopt;
  return WeightEnergy(at, Size(at.body) * *Mass(at.body), Gravity());
}

}  // namespace lacuna
