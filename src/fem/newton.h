// Newton's method for the positions at the end of a step.
#ifndef LACUNA_FEM_NEWTON_H_
#define LACUNA_FEM_NEWTON_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/linear_solver.h"
#include "fem/step_equation.h"

namespace lacuna {

// r(x) = applied, at the nodes that are not fixed.
struct NewtonProblem {
  const StepEquation& equation;
  const Eigen::VectorXd& applied_force;  // 3n, N
  const std::vector<char>& fixed;        // n
  double relative_tolerance = 0;         // of ‖r − applied‖ to the forces at work
  int max_iterations = 0;
};

struct NewtonSummary {
  enum class Status { kNotRun, kConverged, kNoConvergence, kLinearSolverFailed };
  Status status = Status::kNotRun;
  std::string message;
  int iterations = 0;
  double residual = 0;  // ‖r − applied‖∞ at the free nodes, N
  bool IsUsable() const { return status == Status::kConverged; }
};

// Starts at `*position` and moves the fixed nodes to their places in `target` with the first,
// linearised, iteration, so that their neighbours follow. `tangent` is the matrix to work in. On
// failure `*position` is where the iteration ended.
NewtonSummary SolveByNewton(const NewtonProblem& problem, const Eigen::VectorXd& target,
                            LinearSolver* solver, BlockMatrix* tangent, Eigen::VectorXd* position);

}  // namespace lacuna

#endif  // LACUNA_FEM_NEWTON_H_
