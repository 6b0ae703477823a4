#include "effects/free_strain.h"

#include <glog/logging.h>

namespace lacuna {

const Effect& FreeStrain::Law(const Kinematics& at) {
  CHECK(at.elasticity != nullptr) << "a free strain is relative to an elasticity law";
  return *at.elasticity;
}

Kinematics FreeStrain::AsSeenByLaw(const Kinematics& at, const Body& body,
                                   const Eigen::VectorXd& position) {
  static const Eigen::VectorXd no_memory;
  return {.body = body,
          .position = position,
          .velocity = at.velocity,
          .acceleration = at.acceleration,
          .time = at.time,
          .time_step = at.time_step,
          .state = no_memory,
          .elasticity = at.elasticity,
          .has_inertia = at.has_inertia};
}

void FreeStrain::AddDifference(const Kinematics& at, const AddOfLaw& add,
                               Eigen::VectorXd* result) const {
  if (HasNoStrain()) return;
  Eigen::VectorXd of_law = Eigen::VectorXd::Zero(result->size());
  WithElasticPart(at, [&](const ElasticPart& elastic) {
    add(elastic.state, &of_law);
    *result += elastic.force_factor * of_law;
  });
  of_law.setZero();
  add(AsSeenByLaw(at, at.body, at.position), &of_law);
  *result -= of_law;
}

void FreeStrain::AddForce(const Kinematics& at, Eigen::VectorXd* force) const {
  AddDifference(
      at,
      [&](const Kinematics& state, Eigen::VectorXd* of_law) { Law(at).AddForce(state, of_law); },
      force);
}

void FreeStrain::AddElasticityDerivative(const Kinematics& at, int parameter,
                                         Eigen::VectorXd* derivative) const {
  AddDifference(
      at,
      [&](const Kinematics& state, Eigen::VectorXd* of_law) {
        Law(at).AddParameterDerivative(state, parameter, of_law);
      },
      derivative);
}

bool FreeStrain::AddStress(const Kinematics& at, Eigen::Matrix3Xd* stress) const {
  if (HasNoStrain()) return true;
  Eigen::Matrix3Xd of_law = Eigen::Matrix3Xd::Zero(3, stress->cols());
  WithElasticPart(at,
                  [&](const ElasticPart& elastic) { Law(at).AddStress(elastic.state, &of_law); });
  const Eigen::VectorXd stretch = Stretches(at.body);
  for (Eigen::Index q = 0; q < stretch.size(); ++q)
    stress->middleCols<3>(3 * q) += stretch[q] * stretch[q] * of_law.middleCols<3>(3 * q);
  of_law.setZero();
  Law(at).AddStress(AsSeenByLaw(at, at.body, at.position), &of_law);
  *stress -= of_law;
  return true;
}

void FreeStrain::AddTangents(const Kinematics& at, const TangentWeights& weights, bool convexify,
                             BlockMatrix* tangent) const {
  if (HasNoStrain() || weights.position == 0 || convexify) return;
  WithElasticPart(at, [&](const ElasticPart& elastic) {
    Law(at).AddTangents(elastic.state, {.position = weights.position * elastic.tangent_factor},
                        false, tangent);
  });
  Law(at).AddTangents(AsSeenByLaw(at, at.body, at.position), {.position = -weights.position}, false,
                      tangent);
}

std::optional<double> FreeStrain::Energy(const Kinematics& at) const {
  if (HasNoStrain()) return 0.0;
  std::optional<double> stored;
  WithElasticPart(at, [&](const ElasticPart& elastic) {
    stored = Law(at).Energy(elastic.state);
    if (stored) *stored *= elastic.energy_factor;
  });
  const std::optional<double> unstrained = Law(at).Energy(AsSeenByLaw(at, at.body, at.position));
  if (!stored || !unstrained) return std::nullopt;
  return *stored - *unstrained;
}

void FreeStrain::AddForceAndStiffness(const Kinematics& at, const Kinematics& state, double factor,
                                      Eigen::VectorXd* result) {
  Eigen::VectorXd of_law = Eigen::VectorXd::Zero(result->size());
  Law(at).AddForce(state, &of_law);
  *result += factor * of_law;
  BlockMatrix stiffness(at.body.pattern);
  Law(at).AddTangents(state, {.position = 1}, false, &stiffness);
  stiffness.Multiply(at.position, &of_law);
  *result -= of_law;
}

}  // namespace lacuna
