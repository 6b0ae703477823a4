// The fit of a study with a time step as short as its recordings ask for.
#ifndef LACUNA_CALIBRATION_STEPPED_FIT_H_
#define LACUNA_CALIBRATION_STEPPED_FIT_H_

#include <Eigen/Core>

#include "calibration/calibration_problem.h"
#include "core/progress.h"

namespace lacuna {

struct SteppedFit {
  Calibration calibration;
  // By how much half the step would change the predicted frames that are fitted, rms of their
  // components, in σ. Three quarters of the step's error where that goes with its square, half of
  // it in schemes of first order.
  double step_error = 0;
};

// CalibrationProblem::FitFromStart. Where the study leaves its step open, it is shortened until
// step_error is below a part of the noise or of what the model leaves, and the fit goes on from
// where it was. `study`: gets the step that was chosen.
SteppedFit FitWithItsStep(const TetMesh& mesh, PredictionStudy* study, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_STEPPED_FIT_H_
