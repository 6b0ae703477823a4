// Options of Calibrate (fit/calibration.h).
#ifndef LACUNA_FIT_CALIBRATION_OPTIONS_H_
#define LACUNA_FIT_CALIBRATION_OPTIONS_H_

#include <limits>

namespace lacuna {

struct CalibrationOptions {
  // Largest number of iterations of the optimiser. A larger value delays giving up.
  int max_iterations = 30;
  // The iteration stops when a step reduces the cost by less than this fraction of the mean cost
  // of one measurement. A smaller value costs iterations for changes well within the intervals.
  double cost_tolerance = 0.05;
  // The search ends once it has made so many predictions; its best parameters are then given, and
  // the result says that it has not converged. A larger value delays giving up.
  int max_predictions = std::numeric_limits<int>::max();
  // A start whose residual has at most this root mean square, in standard deviations of the noise,
  // is near the solution: exact Jacobians are then evaluated only at the start and at the end, and
  // Broyden's updates (Math. Comp. 19, 1965) replace them in between. If the end turns out
  // not to be a minimum, the search continues from there. 0 always uses exact Jacobians.
  double near_rms = 0;
};

}  // namespace lacuna

#endif  // LACUNA_FIT_CALIBRATION_OPTIONS_H_
