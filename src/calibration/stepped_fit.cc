#include "calibration/stepped_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibration/calibration_fits.h"

namespace lacuna {
namespace {

// A step is short enough when its error is below this part of σ, or of what the model leaves.
constexpr double kOfNoise = 0.2, kOfMisfit = 0.05;
// The next step has this part of the error that is allowed, by the scheme's order; and it is
// not believed to be so many times shorter before looking again.
constexpr double kAimedAt = 0.8, kAtOnce = 4;
constexpr int kMostSteps = 8;

// Of a step that could not be checked: half of it may do.
struct StepCheck {
  double error = std::numeric_limits<double>::infinity();  // σ; and what is allowed:
  double allowed = kOfNoise;
  int order = 2;

  // The part of the step that would do.
  double Share() const {
    if (!std::isfinite(error)) return 0.5;
    if (error <= allowed) return 1;
    return std::max(std::pow(kAimedAt * allowed / error, 1.0 / order), 1 / kAtOnce);
  }
};

StepCheck CheckStep(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                    Progress* progress) {
  progress->Begin("time step", 0);
  PredictionStudy half = problem.WithEstimatedNoise();
  half.time_step /= 2;
  const CalibrationProblem refined(half, problem.body()->mesh);
  // Compared with the same points of scans: the difference is that of the predictions.
  constexpr double kWhole = std::numeric_limits<double>::infinity();
  CalibrationProblem::FitMemory same;
  const Prediction now = problem.Predict(values, false, kWhole, &same);
  const Prediction then = now.usable ? refined.Predict(values, false, kWhole, &same) : now;
  StepCheck check;
  check.order = OrderOf(half.scheme);
  if (now.usable && then.usable && now.residual.size() == then.residual.size()) {
    check.error = RootMeanSquare(Eigen::VectorXd(then.residual - now.residual));
    check.allowed = std::max(kOfNoise, kOfMisfit * RootMeanSquare(now.residual));
  }
  progress->End(fmt::format("{:.3g} ms, good to {:.2g} σ", 2e3 * half.time_step, check.error));
  return check;
}

}  // namespace

SteppedFit FitWithAdaptiveTimeStep(const TetMesh& mesh, PredictionStudy* study,
                                   Progress* progress) {
  SteppedFit fit;
  Calibration beginning;
  if (study->chooses_time_step) {
    // A first look at how fast things go.
    PredictionStudy further;
    {
      const CalibrationProblem problem(*study, mesh);
      beginning = FitShortHorizon(problem, problem.Start(), progress);
      further = problem.WithEstimatedNoise();
      if (beginning.usable)
        further.time_step *= CheckStep(problem, beginning.parameters, progress).Share();
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
      const bool goes_on = fit.calibration.usable;
      const bool has_begun = tried == 1 && beginning.usable;
      fit.calibration = goes_on ? RefineFit(problem, fit.calibration.parameters, progress)
                                : FitFromStart(problem, progress, has_begun ? &beginning : nullptr);
      if (!goes_on) start_rms = fit.calibration.start_rms;
      predictions += fit.calibration.predictions;
      fit.calibration.predictions = predictions;
      fit.calibration.start_rms = start_rms;
      if (!study->chooses_time_step) return fit;
      if (fit.calibration.usable) {
        check = CheckStep(problem, fit.calibration.parameters, progress);
        fit.step_error = check.error;
        if (check.Share() == 1) return fit;
      }
      if (tried == kMostSteps) return fit;
      further = problem.WithEstimatedNoise();
    }
    further.time_step *= check.Share();
    *study = std::move(further);
  }
}

}  // namespace lacuna
