#include "calibration/adaptive_time_step.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "calibration/calibration_fits.h"
#include "core/quantity.h"

namespace lacuna {
namespace {

// A time step is short enough when its error is less than kOfNoise σ or less than kOfMisfit times
// the rms residual.
constexpr double kOfNoise = 0.2, kOfMisfit = 0.05;
// The next time step aims at this share of the error that is allowed, extrapolated by the order of
// the scheme. A step is shortened at most kAtOnce times before its error is estimated again.
constexpr double kAimedAt = 0.8, kAtOnce = 4;
constexpr int kMostSteps = 8;

// The estimated error of a time step; infinite where it could not be estimated.
struct StepCheck {
  double error = std::numeric_limits<double>::infinity();  // σ
  double allowed = kOfNoise;                               // σ, the largest error that is accepted
  int order = 2;

  // The factor by which to shorten the step, 1 where it is short enough.
  double Share() const {
    if (!std::isfinite(error)) return 0.5;
    if (error <= allowed) return 1;
    return std::max(std::pow(kAimedAt * allowed / error, 1.0 / order), 1 / kAtOnce);
  }
};

// Takes a prediction with the step of `problem` and one with half of it from the budget.
StepCheck CheckStep(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                    FitBudget* budget, Progress* progress) {
  progress->Begin("time step", 0);
  PredictionStudy half = problem.WithEstimatedNoise();
  half.time_step /= 2;
  const CalibrationProblem refined(half, problem.body()->mesh);
  // Both are compared with the same scanned points, so that only the predictions differ.
  constexpr double kWhole = std::numeric_limits<double>::infinity();
  CalibrationProblem::FitMemory same;
  budget->Spend(1, problem.study().time_step);
  const ResidualEvaluation now = problem.Predict(values, false, kWhole, &same);
  if (now.usable) budget->Spend(1, half.time_step);
  const ResidualEvaluation then = now.usable ? refined.Predict(values, false, kWhole, &same) : now;
  StepCheck check;
  check.order = OrderOf(half.scheme);
  if (now.usable && then.usable && now.residual.size() == then.residual.size()) {
    ResidualEvaluation change = now;
    change.residual = then.residual - now.residual;
    check.error = RootMeanSquare(change);
    check.allowed = std::max(kOfNoise, kOfMisfit * RootMeanSquare(now));
  }
  progress->End(
      fmt::format("{}, error about {:.2g} σ", DurationText(2 * half.time_step), check.error));
  return check;
}

// AdaptedFit::note where the search ends with a step that fails this check.
std::string NoteOn(const StepCheck& check, double time_step, bool is_out_of_steps) {
  const std::string found =
      std::isfinite(check.error)
          ? fmt::format(
                "half of it would change the fitted frames by {:.2g} σ, where {:.2g} σ are "
                "allowed",
                check.error, check.allowed)
          : "its error is not known, because the motion could not be predicted with half of it";
  return fmt::format(
      "the time step of {} may be too long: {}, and {}; motion.time_step gives a shorter "
      "one",
      DurationText(time_step), found,
      is_out_of_steps ? fmt::format("{} step lengths were tried", kMostSteps)
                      : "the predictions that a fit may take are used up");
}

}  // namespace

AdaptedFit FitWithAdaptiveTimeStep(const TetMesh& mesh, PredictionStudy* study, Progress* progress,
                                   FitStore* kept, FitBudget* budget) {
  AdaptedFit fit;
  FitBudget own(study->time_step);
  FitBudget& spent = budget != nullptr ? *budget : own;
  Calibration beginning;
  if (study->chooses_time_step) {
    // A first estimate of the step, from the short horizon.
    PredictionStudy further;
    {
      const CalibrationProblem problem(*study, mesh);
      beginning = FitShortHorizon(problem, problem.Start(), progress, &spent, kept);
      further = problem.WithEstimatedNoise();
      if (beginning.usable)
        further.time_step *= CheckStep(problem, beginning.parameters, &spent, progress).Share();
    }
    *study = std::move(further);
  }
  int predictions = 0;
  double start_rms = 0;
  for (int tried = 1;; ++tried) {
    PredictionStudy further;
    StepCheck check;
    {
      const CalibrationProblem problem(*study, mesh);
      const bool goes_on = fit.calibration.HasSolution();
      const bool has_begun = tried == 1 && beginning.parameters.size() > 0;
      fit.calibration =
          goes_on ? RefineFit(problem, fit.calibration.parameters, progress, &spent, kept)
                  : FitFromStart(problem, progress, has_begun ? &beginning : nullptr, &spent, kept);
      if (!goes_on) start_rms = fit.calibration.start_rms;
      predictions += fit.calibration.predictions;
      fit.calibration.predictions = predictions;
      fit.calibration.start_rms = start_rms;
      if (!study->chooses_time_step) return fit;
      if (fit.calibration.HasSolution()) {
        check = CheckStep(problem, fit.calibration.parameters, &spent, progress);
        fit.step_error = check.error;
        if (check.Share() == 1) return fit;
      }
      further = problem.WithEstimatedNoise();
      further.time_step *= check.Share();
      const bool is_out_of_steps = tried == kMostSteps;
      if (is_out_of_steps || spent.IsUsedUp(further.time_step)) {
        if (fit.calibration.HasSolution())
          fit.note = NoteOn(check, study->time_step, is_out_of_steps);
        return fit;
      }
    }
    *study = std::move(further);
  }
}

}  // namespace lacuna
