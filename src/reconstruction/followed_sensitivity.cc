#include "reconstruction/followed_sensitivity.h"

namespace lacuna {
namespace {

std::vector<Perturbation> PerturbationsOf(const Model& model, const std::vector<int>& parameters) {
  std::vector<Perturbation> perturbations;
  for (const int parameter : parameters)
    perturbations.push_back({.effect = model.effects.front(), .parameter = parameter});
  return perturbations;
}

}  // namespace

bool HasModulusSensitivity(const ForceSettings& forces) { return !forces.AreFitted(); }

FollowedSensitivity::FollowedSensitivity(const Model& model, const std::vector<int>& parameters)
    : linear_(model, PerturbationsOf(model, parameters)) {}

void FollowedSensitivity::Advance(const MotionHistory& before, TimeScheme scheme, double time_step,
                                  const Eigen::VectorXd& position) {
  usable_ = usable_ && linear_.Advance(before, scheme, time_step, position).IsUsable();
  position_ = usable_ ? linear_.position() : Eigen::MatrixXd();
}

}  // namespace lacuna
