#include "fem/newton_problem.h"

#include <cmath>

namespace lacuna {

NewtonIterate EvaluateIterate(const NewtonProblem& problem, const Eigen::VectorXd& position) {
  NewtonIterate at;
  at.position = position;
  problem.equation.Residual(position, &at.residual, &at.force_scale);
  at.residual -= problem.applied_force;
  at.force_scale += problem.applied_force.norm();
  problem.held.ClearIn(at.residual);
  return at;
}

Eigen::VectorXd WithHeldAt(const NewtonProblem& problem, const Eigen::VectorXd& target,
                           Eigen::VectorXd position) {
  problem.held.Copy(target, &position);
  return position;
}

bool IsWithinTolerance(const NewtonProblem& problem, const NewtonIterate& at) {
  const double norm = at.residual.norm();
  return std::isfinite(norm) && std::isfinite(at.force_scale) &&
         norm <= problem.relative_tolerance * at.force_scale;
}

}  // namespace lacuna
