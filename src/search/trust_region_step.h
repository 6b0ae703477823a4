// The linear trust-region problem of COBYLA (M. J. D. Powell, "A direct search optimization method
// that models the objective and constraint functions by linear interpolation", 1994, section 2).
#ifndef LACUNA_SEARCH_TRUST_REGION_STEP_H_
#define LACUNA_SEARCH_TRUST_REGION_STEP_H_

#include <Eigen/Core>

namespace lacuna {

// f(x + d) ≈ value + gradient·d and c(x + d) ≈ constraints + jacobian d.
struct LinearInterpolant {
  double value = 0;
  Eigen::VectorXd gradient;     // n
  Eigen::VectorXd constraints;  // m, feasible if >= 0
  Eigen::MatrixXd jacobian;     // m × n
};

struct TrustRegionStep {
  Eigen::VectorXd step;      // n
  bool on_boundary = false;  // ‖step‖ = radius
};

// Among the steps with ‖d‖ <= radius and lower <= d <= upper (n each; the bounds must include 0),
// returns the one that
//   1. minimises the largest violation max(0, max_i -(c + J d)_i),
//   2. of these steps, minimises g·d,
//   3. of these steps, is the shortest.
// The step is the end of a piecewise linear path: for a decreasing violation, and then for an
// increasing weight of the objective, the shortest d is followed from one change of the active
// constraints to the next (parametric quadratic programming). Each of the two parts makes at most
// 100 (m + 2 n + 1) changes; a part that reaches this limit ends at its current point.
TrustRegionStep SolveTrustRegion(const LinearInterpolant& model, const Eigen::VectorXd& lower,
                                 const Eigen::VectorXd& upper, double radius);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_TRUST_REGION_STEP_H_
