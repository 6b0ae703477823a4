// The linear trust-region problem of COBYLA (M. J. D. Powell, "A direct search optimization method
// that models the objective and constraint functions by linear interpolation", 1994, section 2).
#ifndef LACUNA_SEARCH_TRUST_REGION_STEP_H_
#define LACUNA_SEARCH_TRUST_REGION_STEP_H_

#include <Eigen/Core>

namespace lacuna {

// f(x + d) ≈ value + gradient·d and c(x + d) ≈ constraints + jacobian d.
struct LinearModel {
  double value = 0;
  Eigen::VectorXd gradient;     // n
  Eigen::VectorXd constraints;  // m, feasible where >= 0
  Eigen::MatrixXd jacobian;     // m × n
};

struct TrustRegionStep {
  Eigen::VectorXd step;      // n
  bool on_boundary = false;  // ‖step‖ = radius
};

// Within ‖d‖ <= radius and lower <= d <= upper (0 lies between them), the d that
//   1. makes the largest violation max(0, max_i -(c + J d)_i) least,
//   2. among those, makes g·d least,
//   3. among those, is shortest.
// The three together are the end of one piecewise linear path: for a falling violation, and then
// for a growing weight on the objective, the shortest d is followed from one change of its active
// constraints to the next (parametric quadratic programming). At most 100 (m + 2 n + 1) such
// changes are made in each of the two parts.
TrustRegionStep SolveTrustRegion(const LinearModel& model, const Eigen::VectorXd& lower,
                                 const Eigen::VectorXd& upper, double radius);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_TRUST_REGION_STEP_H_
