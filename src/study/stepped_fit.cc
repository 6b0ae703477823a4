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
constexpr int kMostHalvings = 6;
constexpr int kAtOnce = 2;  // halvings that are believed before looking again

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
  int halvings = 0, predictions = 0;
  double start_rms = 0;
  while (true) {
    PredictionStudy further;
    int shorter = 1;
    {
      const CalibrationProblem problem(*study, mesh);
      const bool goes_on = fit.calibration.usable;
      fit.calibration = goes_on ? problem.FitOn(fit.calibration.parameters, progress)
                                : problem.FitFromStart(progress);
      if (!goes_on) start_rms = fit.calibration.start_rms;
      predictions += fit.calibration.predictions;
      fit.calibration.predictions = predictions;
      fit.calibration.start_rms = start_rms;
      if (!study->chooses_time_step || halvings >= kMostHalvings) return fit;
      if (fit.calibration.usable) {
        progress->Begin("time step", 0);
        fit.step_error = StepError(problem, fit.calibration);
        progress->End(
            fmt::format("{:.3g} ms, good to {:.2g} σ", 1e3 * study->time_step, fit.step_error));
        const double allowed = std::max(kOfNoise, kOfMisfit * fit.calibration.rms);
        if (fit.step_error <= allowed) return fit;
        if (std::isfinite(fit.step_error))
          shorter = static_cast<int>(std::ceil(0.5 * std::log2(fit.step_error / allowed)));
      }
      further = problem.WithGivenNoise();
    }
    shorter = std::clamp(shorter, 1, std::min(kAtOnce, kMostHalvings - halvings));
    halvings += shorter;
    further.time_step = std::ldexp(further.time_step, -shorter);
    *study = std::move(further);
  }
}

}  // namespace lacuna
