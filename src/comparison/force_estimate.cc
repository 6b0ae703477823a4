#include "comparison/force_estimate.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "analysis/amplitude_estimate.h"
#include "calibration/calibration_problem.h"
#include "comparison/force_linearisation.h"
#include "comparison/force_measures.h"
#include "effects/free_fall.h"

namespace lacuna {
namespace {

constexpr double kLargestWidth = kStandardGravity;  // m/s², upper limit of the width s of the prior
// The search has converged when the error along the new motion differs from the linear prediction
// by less than this share of the prediction, or by less than this many σ. Smaller: more
// predictions.
constexpr double kAgreement = 0.1;
constexpr double kAgreementOverSigma = 0.5;
// ... and if the error is by no more than this share larger than before the step, or than
// predicted: near the solution, where a step hardly changes it, it may grow by the curvature alone.
// Larger: a step that makes matters worse may end the search.
constexpr double kSameError = 0.01;
constexpr double kShortestStep = 0.2;  // a step that does not reduce the error is halved down to it
constexpr int kMostPredictions = 8;
// A step is refused after which fewer than this share of the patches of a scan are observed, of
// those along the motion without a force: an error that is no longer observed is not a smaller
// error. Which markers are observed does not depend on the motion.
constexpr double kFewestObserved = 0.9;
// A search that has not converged is used only if the remaining error is less than this fraction of
// the error without the force.
constexpr double kWorthwhile = 0.5;
// Candidates for the prior: how much the force varies over the object relative to its mean, and
// over how many knots it stays correlated.
constexpr double kVariations[] = {0.1, 1};
constexpr double kPersistences[] = {0.7, 12};

std::vector<Eigen::MatrixXd> PriorShapes(int knots) {
  std::vector<Eigen::MatrixXd> shapes;
  for (const double persistence : kPersistences)
    for (const double variation : kVariations)
      shapes.push_back(PersistentPriorRoot(knots, persistence, variation));
  return shapes;
}

// The current force, and the motion with it.
struct SearchState {
  ReplayedMotion motion;
  Eigen::VectorXd amplitudes;                 // amplitudes of the field, column by column
  std::optional<AmplitudeEstimate> estimate;  // source of the amplitudes; absent at first
  double fewest_rows = 0;                     // a step that leaves fewer observed rows is refused
};

// The result of a full Gauss–Newton step according to the linear model.
struct ForceStep {
  AmplitudeEstimate estimate;
  Eigen::VectorXd nuisance;
  double rms_before = 0, expected_rms = 0;  // rms of the whitened residual
};

ForceStep LinearStep(const LinearisedForce& at, const SearchState& state,
                     const Eigen::VectorXd& prior_deviations,
                     const std::vector<Eigen::MatrixXd>& priors) {
  // The residual without force and nuisances, because their priors have mean 0.
  const Eigen::VectorXd without = at.residual - at.force_jacobian * state.amplitudes -
                                  at.nuisance_jacobian * state.motion.nuisance;
  ForceStep step;
  step.rms_before = at.Rms(at.residual);
  step.estimate = EstimateAmplitudes(FittedModel(without, at.nuisance_jacobian, prior_deviations),
                                     at.force_jacobian, at.coordinates, kLargestWidth, priors);
  const Eigen::VectorXd with = without + at.force_jacobian * step.estimate.mean;
  Eigen::MatrixXd information = at.nuisance_jacobian.transpose() * at.nuisance_jacobian;
  information.diagonal() += prior_deviations.cwiseAbs2().cwiseInverse();
  step.nuisance = -information.ldlt().solve(at.nuisance_jacobian.transpose() * with);
  for (size_t k = 0; k < at.is_kept.size(); ++k)
    if (at.is_kept[k])
      step.nuisance[static_cast<Eigen::Index>(k)] =
          state.motion.nuisance[static_cast<Eigen::Index>(k)];
  step.expected_rms = at.Rms(with + at.nuisance_jacobian * step.nuisance);
  return step;
}

// Shortens the step until the error of the nonlinear model decreases. Returns false, and leaves the
// state unchanged, where no such step was found.
bool TakeStep(const RecordingModel& recording, const ForceLinearisation& linearisation,
              const ForceStep& step, SearchState* state, SmoothForce* field, ForceFitSummary* fit) {
  for (double share = 1; share >= kShortestStep && fit->predictions < kMostPredictions;
       share /= 2) {
    const Eigen::VectorXd amplitudes =
        state->amplitudes + share * (step.estimate.mean - state->amplitudes);
    field->amplitudes.reshaped() = amplitudes;
    ReplayedMotion trial =
        Replay(recording, state->motion.nuisance + share * (step.nuisance - state->motion.nuisance),
               field->Effects());
    ++fit->predictions;
    if (!trial.summary.IsUsable() || linearisation.Coordinates(trial) < state->fewest_rows)
      continue;
    const double reached = linearisation.Rms(trial);
    fit->converged = share == 1 && HasConverged(step.rms_before, step.expected_rms, reached);
    if (!fit->converged && reached >= step.rms_before) continue;
    state->motion = std::move(trial);
    state->amplitudes = amplitudes;
    state->estimate = step.estimate;
    fit->rms_over_sigma_with = reached;
    return true;
  }
  return false;
}

// Searches for the force, starting from the motion without one. Returns the reason why the search
// failed, empty where it did not.
std::string Search(const RecordingModel& recording, const ForceLinearisation& linearisation,
                   SearchState* state, SmoothForce* field, ForceFitSummary* fit) {
  std::vector<Eigen::MatrixXd> priors = PriorShapes(field->KnotCount());
  bool stuck = false;
  for (int pass = 0; !fit->converged && !stuck && fit->predictions < kMostPredictions; ++pass) {
    const ReducedResponse response = linearisation.Response(state->motion);
    if (!response.IsUsable()) return response.message();
    const LinearisedForce at = linearisation.Linearise(state->motion, response);
    const ForceStep step = LinearStep(at, *state, linearisation.prior_deviations(), priors);
    if (pass == 0) fit->rms_over_sigma_without = step.rms_before;
    // The first pass may be far from the solution; from the second on the prior's shape is kept.
    if (pass == 1) priors = {priors[step.estimate.shape]};
    stuck = !TakeStep(recording, linearisation, step, state, field, fit);
  }
  return "";
}

UnexplainedForce Unusable(UnexplainedForce force, const std::string& why) {
  force.record.message = why;
  return force;
}

}  // namespace

bool HasConverged(double rms_before, double expected_rms, double reached_rms) {
  const bool agrees = std::abs(reached_rms - expected_rms) <
                      std::max(kAgreement * expected_rms, kAgreementOverSigma);
  return agrees && reached_rms < (1 + kSameError) * std::max(rms_before, expected_rms);
}

UnexplainedForce EstimateUnexplainedForce(const RecordingModel& recording,
                                          const ReplayedMotion& motion,
                                          const MeasurementErrors& errors) {
  UnexplainedForce force;
  const std::optional<SmoothForce> zero = SmoothForceDuring(recording, motion, kMostForceKnots);
  if (!zero) return Unusable(force, "there are too few frames after the start of the motion");
  SmoothForce& field = force.field;
  field = *zero;
  const ForceLinearisation linearisation(recording, motion, field, errors);
  if (linearisation.Coordinates(motion) == 0)
    return Unusable(force, "none of its points was observed");
  SearchState state{motion,
                    Eigen::VectorXd::Zero(field.amplitudes.size()),
                    {},
                    kFewestObserved * linearisation.Coordinates(motion)};
  ForceFitSummary& fit = force.record.fit;
  fit.knots = field.KnotCount();
  fit.knot_spacing = field.spacing;
  const std::string problem = Search(recording, linearisation, &state, &field, &fit);
  if (!problem.empty()) return Unusable(force, problem);

  const bool helps = fit.rms_over_sigma_with < kWorthwhile * fit.rms_over_sigma_without;
  if (!state.estimate || (!fit.converged && !helps)) {
    return Unusable(
        force, fit.rms_over_sigma_without > kFarFromTruth
                   ? fmt::format("the model is so far from the {} that no small force reduces the "
                                 "error",
                                 recording.recording().ShowsScans() ? "scans" : "markers")
                   : "no small, smooth force reduces the error enough");
  }
  field.amplitudes.reshaped() = state.amplitudes;
  fit.noise_scale = state.estimate->noise;
  fit.log_evidence = state.estimate->evidence;
  MeasureForce(recording.model(), state.motion, state.estimate->covariance, &force);
  force.record.usable = true;
  return force;
}

}  // namespace lacuna
