// Options of Calibrate (fit/calibration.h).
#ifndef LACUNA_FIT_CALIBRATION_OPTIONS_H_
#define LACUNA_FIT_CALIBRATION_OPTIONS_H_

#include <limits>

namespace lacuna {

struct CalibrationOptions {
  // The search ends once it has tried this many steps; its best parameters are then given, and the
  // result says that it has not converged. A larger value delays giving up.
  int max_iterations = 30;
  // The search ends where the linearised model predicts a reduction of the cost by less than this
  // fraction of the mean cost of one measurement. A smaller value costs iterations for changes
  // well within the intervals.
  double cost_tolerance = 0.05;
  // The search ends in the same way once it has made this many predictions. A larger value delays
  // giving up.
  int max_predictions = std::numeric_limits<int>::max();
  // The search also ends, as not converged, where twice the gain of a full step would leave a cost
  // (Calibration::cost) above this. It makes a few steps first.
  double hopeless_cost = std::numeric_limits<double>::infinity();
};

}  // namespace lacuna

#endif  // LACUNA_FIT_CALIBRATION_OPTIONS_H_
