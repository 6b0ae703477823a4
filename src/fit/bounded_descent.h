// The minimiser of a calibration: least squares with priors and bounds.
//
// Ceres minimises ½ ‖r(θ)‖² plus the priors in rounds, over unbounded coordinates in which no step
// can leave the bounds. Between the rounds, Gauss–Newton steps with an active set
// (active_bounds.h) put parameters on their bounds or release them, which the unbounded coordinates
// cannot do.
#ifndef LACUNA_FIT_BOUNDED_DESCENT_H_
#define LACUNA_FIT_BOUNDED_DESCENT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fit/calibrated_parameter.h"
#include "fit/calibration_options.h"
#include "fit/prediction_function.h"
#include "fit/secant_predictions.h"

namespace lacuna {

struct DescentEnd {
  Eigen::VectorXd parameters;     // θ, SI, within the bounds
  bool usable = false;            // whether the search has converged
  std::string message;            // why it has not
  int iterations = 0;             // iterations of Ceres in all rounds
  bool is_out_of_budget = false;  // CalibrationOptions::max_predictions has ended it
};

// Searches from the starts of the parameters, of which there must be at least one. `first` is the
// prediction at the starts and must be usable. With `is_near`, the first rounds use Broyden's
// updates in place of exact Jacobians.
DescentEnd Descend(const std::vector<CalibratedParameter>& parameters,
                   const CalibrationOptions& options, const Prediction& first, bool is_near,
                   SecantPredictions* predictions);

}  // namespace lacuna

#endif  // LACUNA_FIT_BOUNDED_DESCENT_H_
