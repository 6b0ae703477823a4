// Gauss–Newton steps within bounds.
#ifndef LACUNA_FIT_ACTIVE_BOUNDS_H_
#define LACUNA_FIT_ACTIVE_BOUNDS_H_

#include <Eigen/Core>

namespace lacuna {

// ½ ‖r + J δ‖².
struct QuadraticCost {
  double cost = 0;              // ½ ‖r‖²
  Eigen::VectorXd gradient;     // Jᵀ r
  Eigen::MatrixXd information;  // Jᵀ J

  // The part of the cost that a step takes away.
  double GainOf(const Eigen::VectorXd& step) const;
};

// The step δ of the least cost in low ≤ δ ≤ high, low ≤ 0 ≤ high, by an active set method (Stark &
// Parker, Comput. Stat. 10, 1995). What J does not see does not move. To cut off what a free step
// does beyond a bound is not the same: where two parameters do nearly the same, the rest of the
// step counts on that part.
Eigen::VectorXd StepWithin(const QuadraticCost& model, const Eigen::VectorXd& low,
                           const Eigen::VectorXd& high);

}  // namespace lacuna

#endif  // LACUNA_FIT_ACTIVE_BOUNDS_H_
