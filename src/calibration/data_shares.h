// How much of the information about each parameter comes from each kind of data.
#ifndef LACUNA_CALIBRATION_DATA_SHARES_H_
#define LACUNA_CALIBRATION_DATA_SHARES_H_

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <vector>

#include "calibration/calibration_problem.h"
#include "record/calibration_record.h"

namespace lacuna {

// FittedParameter::shares for each parameter of the problem, none for a parameter on which no
// prediction depends. Empty where the fitted recordings have one kind of data only, or the model
// cannot be linearised. `on_frame` is LineariseOptions::on_frame of the prediction. Throws
// Interrupted.
std::vector<std::optional<DataShares>> SharesOfData(const CalibrationProblem& problem,
                                                    const Eigen::VectorXd& values,
                                                    const std::function<void()>& on_frame = {});

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_DATA_SHARES_H_
