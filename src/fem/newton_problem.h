// The problem that Newton's method solves (newton.h), and its iterates.
#ifndef LACUNA_FEM_NEWTON_PROBLEM_H_
#define LACUNA_FEM_NEWTON_PROBLEM_H_

#include <Eigen/Core>
#include <optional>

#include "fem/held_components.h"
#include "fem/step_equation.h"

namespace lacuna {

// The references must outlive the solution.
struct NewtonProblem {
  const StepEquation& equation;
  const Eigen::VectorXd& applied_force;  // 3n, N
  const HeldComponents& held;
  double relative_tolerance = 0;  // bound on ‖r − applied‖ relative to the acting forces
  int max_iterations = 0;
};

// An iterate with the quantities that have been evaluated at it. Vectors are 3n, node-major.
struct NewtonIterate {
  Eigen::VectorXd position;         // m
  Eigen::VectorXd residual;         // r − applied force, N; held components are 0
  double force_scale = 0;           // N
  std::optional<double> potential;  // J; NaN if there is none; evaluated on demand
};

NewtonIterate EvaluateIterate(const NewtonProblem& problem, const Eigen::VectorXd& position);

// `position` with the held components of `target` (both 3n, m).
Eigen::VectorXd WithHeldAt(const NewtonProblem& problem, const Eigen::VectorXd& target,
                           Eigen::VectorXd position);

// Whether residual and forces are finite, and the residual is within the tolerance.
bool IsWithinTolerance(const NewtonProblem& problem, const NewtonIterate& at);

}  // namespace lacuna

#endif  // LACUNA_FEM_NEWTON_PROBLEM_H_
