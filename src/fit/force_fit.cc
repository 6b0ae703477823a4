#include "fit/force_fit.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>

#include "fit/coefficient_fit.h"
#include "fit/position_fit.h"

namespace lacuna {
namespace {

Eigen::VectorXd OrZero(const Eigen::VectorXd& given, Eigen::Index size) {
  CHECK(given.size() == size || given.size() == 0);
  return given.size() == size ? given : Eigen::VectorXd::Zero(size);
}

}  // namespace

ForceFit FitStepForces(const Model& model, const StepEquation& equation,
                       const ForceModel& force_model, const Observations& observations,
                       const ForceFitStart& start, const ForceFitPrior& prior,
                       const ForceFitOptions& options) {
  const Eigen::Index unknowns = 3 * model.body->NodeCount();
  CHECK_EQ(start.position.size(), unknowns);
  ForceFit fit;
  fit.position = start.position;
  fit.force = Eigen::VectorXd::Zero(unknowns);
  if (!force_model.HasUnknowns()) {
    fit.status = ForceFit::Status::kNoUnknowns;
    fit.message = "the force model has no unknown forces";
    return fit;
  }
  if (observations.Count() == 0) {
    fit.status = ForceFit::Status::kNothingObserved;
    fit.message = "no observation reaches the model's surface";
    return fit;
  }
  const Eigen::Index coefficients = force_model.CoefficientCount();
  const ForceFitStart full_start{start.position, OrZero(start.coefficients, coefficients),
                                 OrZero(start.multiplier, unknowns)};
  const ForceFitPrior full_prior{OrZero(prior.force, unknowns),
                                 OrZero(prior.coefficients, coefficients)};
  const bool has_free_nodes =
      std::any_of(force_model.free.begin(), force_model.free.end(), [](char free) { return free; });
  const auto fit_by = has_free_nodes ? &FitPositions : &FitCoefficients;
  return fit_by(model, equation, force_model, observations, full_start, full_prior, options);
}

std::vector<char> GrippedNodes(const Model& model) {
  std::vector<char> gripped(model.body->NodeCount(), 0);
  for (const Grip& grip : model.grips)
    for (const int node : grip.nodes) gripped[node] = 1;
  return gripped;
}

double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0 : std::sqrt(sum / static_cast<double>(values.size()));
}

}  // namespace lacuna
