// The influence of errors of the object's measured dimensions on a prediction.
#ifndef LACUNA_CALIBRATION_SIZE_ERRORS_H_
#define LACUNA_CALIBRATION_SIZE_ERRORS_H_

#include <Eigen/Core>
#include <functional>

#include "calibration/calibration_problem.h"

namespace lacuna {

// The change of the rows of `misfit`, m, if the object were larger along x, y and z (one column
// each) by PredictionStudy::size_deviation. Computed by finite differences of predictions with
// `values`, whose LineariseOptions::on_frame is `on_frame`. Without a column if one of them fails
// or if the deviation is 0. Throws Interrupted.
//
// All regions keep their nodes (calibration/listed_nodes.h), so that a grip holds what it held. In
// each recording the object is stretched about the centroid of its first grip, which therefore
// stays where it is; the nodes of other grips are displaced with the object. Without a grip, it is
// stretched about its own centroid.
Eigen::MatrixXd ChangesBySize(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const LinearisedMisfit& misfit,
                              const std::function<void()>& on_frame = {});

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_SIZE_ERRORS_H_
