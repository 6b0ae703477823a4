#include "effects/free_fall.h"

#include <string>

#include "effects/vector_parameters.h"

namespace lacuna {

double WeightEnergy(const Kinematics& at, const Eigen::VectorXd& mass,
                    const Eigen::Vector3d& gravity) {
  double energy = 0;
  for (int i = 0; i < at.body.NodeCount(); ++i)
    energy -= mass[i] * gravity.dot(at.position.segment<3>(3 * i) - at.body.mesh.nodes.col(i));
  return energy;
}

bool IsSameGravity(const Eigen::Vector3d& one, const Eigen::Vector3d& other) {
  constexpr double kRounding = 1e-9;  // of units other than m/s²
  return (one - other).norm() <= kRounding * other.norm();
}

void AppendGravitySetting(EffectCard* card) {
  AppendVector({.name = kGravitySetting,
                .meaning = "acceleration of free fall of the mass: that of the model's gravity, "
                           "which is the default, or 0, 0, 0 where its weight is one of the known "
                           "forces; it must be given in a model without gravity,",
                .dimension = kAcceleration,
                .bounds = kAnyValue,
                .null_value = 0,
                .plausible_min = -kStandardGravity,
                .plausible_max = kStandardGravity,
                .setting = true},
               Eigen::Vector3d::Constant(kMustBeGiven), card);
}

int GravitySettingOn(const EffectCard& card) {
  return ParameterIndex(card, std::string(kGravitySetting) + "_x");
}

std::optional<Eigen::Vector3d> GravitySettingOf(const Effect& effect) {
  const int first = GravitySettingOn(effect.Card());
  if (first < 0) return std::nullopt;
  return effect.Parameters().segment<3>(first);
}

std::shared_ptr<const Effect> WithGravitySetting(const std::shared_ptr<const Effect>& effect,
                                                 const Eigen::Vector3d& gravity) {
  const int first = GravitySettingOn(effect->Card());
  if (first < 0) return effect;
  Eigen::VectorXd values = effect->Parameters();
  values.segment<3>(first) = gravity;
  return effect->WithParameters(values);
}

}  // namespace lacuna
