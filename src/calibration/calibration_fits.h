// Fits of a calibration problem, from a distant start or from near the solution.
//
// All fits use the fitted frames of the fitted recordings. The correspondences of scanned points
// are fixed during a fit and updated after it, until the parameters settle. If they do not settle,
// the result is not usable. All functions throw Interrupted.
#ifndef LACUNA_CALIBRATION_CALIBRATION_FITS_H_
#define LACUNA_CALIBRATION_CALIBRATION_FITS_H_

#include <Eigen/Core>

#include "calibration/calibration_problem.h"
#include "core/progress.h"

namespace lacuna {

// The end of the short horizon, in seconds after a recording's start: a quarter of the fitted time
// in which the object moves, taken from the recording in which that ends last.
double ShortHorizon(const CalibrationProblem& problem);

// Fits over the short horizon, where a wrong model has the least time to diverge.
Calibration FitShortHorizon(const CalibrationProblem& problem, const Eigen::VectorXd& start,
                            Progress* progress);

// Fits over the short horizon first, then over all fitted frames.
Calibration FitInStages(const CalibrationProblem& problem, const Eigen::VectorXd& start,
                        Progress* progress);

// Fits all fitted frames at once, from near the solution.
Calibration RefineFit(const CalibrationProblem& problem, const Eigen::VectorXd& near,
                      Progress* progress);

// Fits from the problem's start. A distant start may lead to a local minimum that is off by a
// period of a vibration: where the residual is far above the noise, the moduli are started from
// other values too and the best fit is kept. `beginning`: the fit over the short horizon, where it
// was made before.
Calibration FitFromStart(const CalibrationProblem& problem, Progress* progress,
                         const Calibration* beginning = nullptr);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_CALIBRATION_FITS_H_
