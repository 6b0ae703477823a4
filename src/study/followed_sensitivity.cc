#include "study/followed_sensitivity.h"

#include "fit/force_response.h"

namespace lacuna {
namespace {

std::vector<Perturbation> PerturbationsOf(const Model& model, const std::vector<int>& parameters) {
  std::vector<Perturbation> perturbations;
  for (const int parameter : parameters)
    perturbations.push_back({.effect = model.effects.front(), .parameter = parameter});
  return perturbations;
}

}  // namespace

bool HasModulusSensitivity(const ForceSettings& forces) {
  using Kind = ForceSettings::Kind;
  return forces.kind != Kind::kFree &&
         !(forces.kind == Kind::kSmooth && forces.traction_scale == 0);
}

FollowedSensitivity::FollowedSensitivity(const Model& model, const ForceModel& forces,
                                         const std::vector<int>& parameters)
    : model_(model), forces_(forces), linear_(model, PerturbationsOf(model, parameters)) {}

void FollowedSensitivity::Advance(const MotionHistory& before, TimeScheme scheme, double time_step,
                                  const Eigen::VectorXd& position, const Observations* seen,
                                  double robust_threshold) {
  if (!message_.empty()) return;
  TangentLinear::ForceAnswer answer;
  ForceResponse response;
  if (seen != nullptr) {
    const StepEquation equation(model_, before, scheme, time_step);
    response = RespondToForces(model_, equation, forces_, position);
    if (!response.IsUsable()) {
      message_ = "the answer to the forces could not be solved for";
      position_.resize(0, 0);
      return;
    }
    answer = [&](const Eigen::MatrixXd& moved) -> Eigen::MatrixXd {
      return response.sensitivity *
             CoefficientAnswer(response, *seen, position, robust_threshold, moved);
    };
  }
  const TangentLinearSummary advanced =
      linear_.Advance(before, scheme, time_step, position, answer);
  if (!advanced.IsUsable()) {
    message_ = advanced.message;
    position_.resize(0, 0);
    return;
  }
  position_ = linear_.position();
}

}  // namespace lacuna
