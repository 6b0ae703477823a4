// The fit of a study whose time step is adapted to its recordings.
#ifndef LACUNA_CALIBRATION_ADAPTIVE_TIME_STEP_H_
#define LACUNA_CALIBRATION_ADAPTIVE_TIME_STEP_H_

#include <Eigen/Core>
#include <string>

#include "calibration/calibration_fits.h"
#include "calibration/calibration_problem.h"
#include "calibration/fit_store.h"
#include "core/progress.h"

namespace lacuna {

struct AdaptedFit {
  Calibration calibration;
  // The rms change of the fitted frames, σ, when the step is halved. It is three quarters of the
  // step's error for a second-order scheme and half of it for a first-order scheme.
  double step_error = 0;
  // Says that the search for the step ended before step_error was small enough, and why. Empty
  // where the step was given or is short enough, and where nothing could be predicted.
  std::string note;
};

// FitFromStart (calibration_fits.h). Where the study does not give a step, it is shortened until
// step_error is small against the noise or the model's residual, and the fit is continued
// each time. The search ends early after eight step lengths, or where the budget of the fit is used
// up, which pays for the estimates of step_error, too. `study` receives the step that was chosen.
// `kept` and `budget`: as in calibration_fits.h. Throws Interrupted.
AdaptedFit FitWithAdaptiveTimeStep(const TetMesh& mesh, PredictionStudy* study, Progress* progress,
                                   FitStore* kept = nullptr, FitBudget* budget = nullptr);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_ADAPTIVE_TIME_STEP_H_
