#include "study/stepped_fit.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace lacuna {
namespace {

// A step is short enough when its error is below this part of σ, or of what the model leaves.
constexpr double kOfNoise = 0.2, kOfMisfit = 0.05;
// The next step has this part of the error that is allowed, by the scheme's second order; and it is
// not believed to be so many times shorter before looking again.
constexpr double kAimedAt = 0.8, kAtOnce = 4;
constexpr int kMostSteps = 8;

double StepError(const CalibrationProblem& problem, const Calibration& calibration) {
  PredictionStudy half = problem.WithGivenNoise();
  half.time_step /= 2;
  const CalibrationProblem refined(half, problem.body()->mesh);
  // Scans are compared where they lie, so patches may be other ones; of the rest the difference is
  // that of the predictions.
  const Prediction now = problem.Predict(calibration.parameters, false);
  const Prediction then = refined.Predict(calibration.parameters, false);
  if (!now.usable || !then.usable || now.residual.size() != then.residual.size())
    return std::numeric_limits<double>::infinity();
  return RootMeanSquare(Eigen::VectorXd(then.residual - now.residual));
}

}  // namespace

SteppedFit FitWithItsStep(const TetMesh& mesh, PredictionStudy* study, Progress* progress) {
  SteppedFit fit;
  int predictions = 0;
  double start_rms = 0;
  for (int tried = 1;; ++tried) {
    PredictionStudy further;
    double share = 0.5;  // of the step
    {
      const CalibrationProblem problem(*study, mesh);
      const bool goes_on = fit.calibration.usable;
      fit.calibration = goes_on ? problem.FitOn(fit.calibration.parameters, progress)
                                : problem.FitFromStart(progress);
      if (!goes_on) start_rms = fit.calibration.start_rms;
      predictions += fit.calibration.predictions;
      fit.calibration.predictions = predictions;
      fit.calibration.start_rms = start_rms;
      if (!study->chooses_time_step) return fit;
      if (fit.calibration.usable) {
        progress->Begin("time step", 0);
        fit.step_error = StepError(problem, fit.calibration);
        progress->End(
            fmt::format("{:.3g} ms, good to {:.2g} σ", 1e3 * study->time_step, fit.step_error));
        const double allowed = std::max(kOfNoise, kOfMisfit * fit.calibration.rms);
        if (fit.step_error <= allowed) return fit;
        if (std::isfinite(fit.step_error))
          share = std::max(std::sqrt(kAimedAt * allowed / fit.step_error), 1 / kAtOnce);
      }
      if (tried == kMostSteps) return fit;
      further = problem.WithGivenNoise();
    }
    further.time_step *= share;
    *study = std::move(further);
  }
}

}  // namespace lacuna
