// How a prediction study's parameters are found: from far away, or on from near the solution.
//
// All fits are over the fitted frames of the fitted recordings. Of scans, the points' places on the
// surface are kept during a fit and sought again after it, until the parameters settle; where they
// do not, the result is not usable.
#ifndef LACUNA_CALIBRATION_CALIBRATION_FITS_H_
#define LACUNA_CALIBRATION_CALIBRATION_FITS_H_

#include <Eigen/Core>

#include "calibration/calibration_problem.h"
#include "core/progress.h"

namespace lacuna {

// s after a recording's start: a quarter of the fitted time in which the object moves, of the
// recording where that ends last.
double ShortHorizon(const CalibrationProblem& problem);

// Over the short horizon, where a wrong model is least wrong.
Calibration FitBeginning(const CalibrationProblem& problem, const Eigen::VectorXd& start,
                         Progress* progress);

// The beginning first, then all of the fitted frames.
Calibration FitFrom(const CalibrationProblem& problem, const Eigen::VectorXd& start,
                    Progress* progress);

// All of the fitted frames at once, from near the solution.
Calibration FitOn(const CalibrationProblem& problem, const Eigen::VectorXd& near,
                  Progress* progress);

// From the problem's start. A fit from far away may end where it is off by a period of a vibration:
// where it leaves far more than noise, the moduli are started from elsewhere too, and the best is
// kept. `beginning`: its first part, where that has been fitted before.
Calibration FitFromStart(const CalibrationProblem& problem, Progress* progress,
                         const Calibration* beginning = nullptr);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_CALIBRATION_FITS_H_
