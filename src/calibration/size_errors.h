// The influence of errors of the object's measured dimensions on a prediction.
#ifndef LACUNA_CALIBRATION_SIZE_ERRORS_H_
#define LACUNA_CALIBRATION_SIZE_ERRORS_H_

#include <Eigen/Core>

#include "calibration/calibration_problem.h"

namespace lacuna {

// The change of the rows of `misfit`, m, if the object were larger along x, y and z (one column
// each) by PredictionStudy::size_deviation; a gripped face stays in its grip. Computed by finite
// differences of predictions with `values`. Empty if one of them fails or if the deviation is 0.
// Throws Interrupted.
Eigen::MatrixXd ChangesBySize(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const LinearisedMisfit& misfit);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_SIZE_ERRORS_H_
