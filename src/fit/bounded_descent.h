// The search of a calibration: Ceres in rounds, and between them Gauss–Newton steps that meet
// bounds.
#ifndef LACUNA_FIT_BOUNDED_DESCENT_H_
#define LACUNA_FIT_BOUNDED_DESCENT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/calibration.h"
#include "fit/secant_predictions.h"

namespace lacuna {

struct DescentEnd {
  Eigen::VectorXd parameters;  // θ, within the bounds
  bool usable = false;         // it has come to an end; otherwise `message` says what kept it
  std::string message;
  int iterations = 0;  // Ceres', of all rounds
};

// The least ½ ‖r‖² and priors, from the parameters' starts, of which there is one at least.
// `first`: the prediction there, usable. `is_near`: Broyden's secants may stand in for derivatives.
DescentEnd Descend(const std::vector<CalibratedParameter>& parameters,
                   const CalibrationOptions& options, const Prediction& first, bool is_near,
                   SecantPredictions* predictions);

}  // namespace lacuna

#endif  // LACUNA_FIT_BOUNDED_DESCENT_H_
