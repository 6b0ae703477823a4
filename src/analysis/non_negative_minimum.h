// Where a strictly convex quadratic function f(x) is least if some of its arguments must not be
// negative.
#ifndef LACUNA_ANALYSIS_NON_NEGATIVE_MINIMUM_H_
#define LACUNA_ANALYSIS_NON_NEGATIVE_MINIMUM_H_

#include <Eigen/Core>
#include <functional>
#include <vector>

namespace lacuna {

// The least value of f where some arguments are held at 0 and the others are free, negative ones
// included.
struct MinimumWithZeros {
  Eigen::VectorXd at;      // x
  Eigen::VectorXd slopes;  // ∂f/∂x of the held arguments, in their order, each in any positive unit
  double value = 0;        // f in any positive unit, up to a constant
};
// From the indices of the held arguments, in ascending order.
using MinimizeWithZeros = std::function<MinimumWithZeros(const std::vector<Eigen::Index>& zeros)>;

struct NonNegativeMinimum {
  Eigen::VectorXd at;               // x
  std::vector<Eigen::Index> zeros;  // the arguments that are held at 0, in ascending order
};

// The minimum of f with x ≥ 0 for the arguments of the indices `restricted`, by the active-set
// method of C. L. Lawson & R. J. Hanson (Solving Least Squares Problems, 1974, ch. 23). It starts
// where all arguments that are negative at the free minimum are held, which is the end in most
// cases. Every further step decreases f, so that it ends after finitely many calls of `minimize`.
NonNegativeMinimum MinimizeNonNegative(const MinimizeWithZeros& minimize,
                                       const std::vector<Eigen::Index>& restricted);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_NON_NEGATIVE_MINIMUM_H_
