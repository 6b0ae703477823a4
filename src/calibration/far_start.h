// Start values for a fit to scans that show the object far from where the model starts, such as a
// body that hangs deeply deformed already in the first frame.
#ifndef LACUNA_CALIBRATION_FAR_START_H_
#define LACUNA_CALIBRATION_FAR_START_H_

#include <Eigen/Core>
#include <string>

#include "calibration/calibration_problem.h"

namespace lacuna {

struct FarStart {
  Eigen::VectorXd values;   // start values of all parameters of the problem
  double reach_factor = 1;  // FitMemory::reach_factor of the first search for correspondences
  int predictions = 0;
  std::string summary;  // what was searched and how near the surface came; empty if not searched
};

// Continuation in the stiffness, for quasi-static studies: where fewer than 85 % of the scanned
// points have a correspondence on the surface predicted at `start`, all fitted moduli are
// multiplied by powers of two, in both directions, while the mean distance of the points from the
// predicted surface decreases. That distance needs no correspondences. Each equilibrium starts from
// the last one. The reach is widened in proportion to the distance that is left. Other studies, and
// those without scans, keep `start`. Throws Interrupted.
FarStart FindFarStart(const CalibrationProblem& problem, const Eigen::VectorXd& start);

}  // namespace lacuna

#endif  // LACUNA_CALIBRATION_FAR_START_H_
