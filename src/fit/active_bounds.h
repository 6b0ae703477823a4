// Gauss–Newton steps within bounds.
#ifndef LACUNA_FIT_ACTIVE_BOUNDS_H_
#define LACUNA_FIT_ACTIVE_BOUNDS_H_

#include <Eigen/Core>

namespace lacuna {

// A quadratic model of a least-squares cost, ½ ‖r + J δ‖², as a function of the step δ.
struct QuadraticCost {
  double cost = 0;              // ½ ‖r‖²
  Eigen::VectorXd gradient;     // Jᵀ r
  Eigen::MatrixXd information;  // Jᵀ J

  // The fraction of the cost that the step removes; 0 if the cost is not positive.
  double GainOf(const Eigen::VectorXd& step) const;
};

// The step of least cost with low ≤ δ ≤ high, where low ≤ 0 ≤ high, by an active-set method (Stark
// & Parker, Comput. Stat. 10, 1995). Directions in which the information is singular are not moved.
// Clipping the unconstrained step at the bounds would not give this step: where two parameters have
// nearly the same effect, one of them compensates for the other beyond its bound.
Eigen::VectorXd StepWithin(const QuadraticCost& model, const Eigen::VectorXd& low,
                           const Eigen::VectorXd& high);

}  // namespace lacuna

#endif  // LACUNA_FIT_ACTIVE_BOUNDS_H_
