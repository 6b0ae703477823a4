#include "fit/step_force_fitter.h"

#include <glog/logging.h>

#include <utility>

#include "fit/balance_control.h"
#include "fit/coefficient_fit.h"
#include "fit/force_response.h"
#include "fit/position_fit.h"

namespace lacuna {
namespace {

Eigen::VectorXd OrZero(const Eigen::VectorXd& given, Eigen::Index size) {
  CHECK(given.size() == size || given.size() == 0);
  return given.size() == size ? given : Eigen::VectorXd::Zero(size);
}

// With more coefficients, the formulation with the positions as unknowns is cheaper.
constexpr Eigen::Index kMaxForces = 12;
// Likewise for the places of the loaded nodes, which need fewer iterations in large deformations.
constexpr Eigen::Index kMaxPlaces = 150;

// How the positions are eliminated; null where they are the unknowns.
std::unique_ptr<BalanceControl> ChooseControl(const Model& model, const StepEquation& equation,
                                              const ForceModel& force_model) {
  const Eigen::Index count = force_model.CoefficientCount();
  if (force_model.HasFreeNodes() || count == 0 || count > kMaxPlaces) return nullptr;
  if (std::unique_ptr<BalanceControl> places = ControlPlaces(model, equation, force_model))
    return places;
  return count <= kMaxForces ? ControlForces(model, force_model) : nullptr;
}

}  // namespace

struct StepForceFitter::Implementation {
  const Model& model;
  const StepEquation& equation;
  const ForceModel& force_model;
  PositionFitStart start;                           // start of the next fit
  std::unique_ptr<CoefficientFitter> coefficients;  // null: positions are unknowns
};

StepForceFitter::StepForceFitter(const Model& model, const StepEquation& equation,
                                 const ForceModel& force_model, const Eigen::VectorXd& position,
                                 const Eigen::VectorXd& coefficients) {
  const Eigen::Index unknowns = 3 * model.body->NodeCount();
  CHECK_EQ(position.size(), unknowns);
  const PositionFitStart start{position, OrZero(coefficients, force_model.CoefficientCount()),
                               Eigen::VectorXd::Zero(unknowns)};
  implementation_ = std::make_unique<Implementation>(
      Implementation{model, equation, force_model, start, nullptr});
  if (std::unique_ptr<BalanceControl> control = ChooseControl(model, equation, force_model)) {
    implementation_->coefficients = std::make_unique<CoefficientFitter>(
        model, equation, force_model, std::move(control), start.position, start.coefficients);
  }
}

StepForceFitter::~StepForceFitter() = default;

ForceFit StepForceFitter::Fit(const Observations& observations, const ForceFitPrior& prior,
                              const ForceFitOptions& options) {
  Implementation& kept = *implementation_;
  ForceFit fit;
  fit.position = kept.start.position;
  fit.force = Eigen::VectorXd::Zero(kept.start.position.size());
  if (!kept.force_model.HasUnknowns()) {
    fit.status = ForceFit::Status::kNoUnknowns;
    fit.message = "the force model has no unknown forces";
    return fit;
  }
  if (observations.Count() == 0) {
    fit.status = ForceFit::Status::kNothingObserved;
    fit.message = "no observation reaches the model's surface";
    return fit;
  }
  const ForceFitPrior full_prior{OrZero(prior.force, kept.start.position.size()),
                                 OrZero(prior.coefficients, kept.force_model.CoefficientCount())};
  if (kept.coefficients) return kept.coefficients->Fit(observations, full_prior, options);
  fit = FitPositions(kept.model, kept.equation, kept.force_model, observations, kept.start,
                     full_prior, options);
  if (fit.IsUsable()) kept.start = {fit.position, fit.coefficients, fit.multiplier};
  return fit;
}

Eigen::MatrixXd StepForceFitter::Covariance(const ForceFit& fit, const Observations& observations,
                                            const ForceFitOptions& options) const {
  const Implementation& kept = *implementation_;
  if (kept.force_model.HasFreeNodes()) return {};
  const ForceResponse response =
      RespondToForces(kept.model, kept.equation, kept.force_model, fit.position);
  if (!response.IsUsable()) return {};
  return CoefficientCovariance(response, observations, fit.position, options.robust_threshold);
}

}  // namespace lacuna
