// Newton's method for the positions at the end of a time step.
//
// Solves r(x) = applied force for the free components, where r is the residual of the equation of
// motion (step_equation.h). Steps with inertia are first tried with the kept factor of an earlier
// tangent (kept_factor_iteration.h); most steps of a smooth motion end there. Otherwise the tangent
// is exact, or a positive definite approximation where the exact one is indefinite, and steps are
// globalised by a line search on the potential of r, or on the work of r along the step if r has no
// potential. The tangent is its symmetric part. Loads that turn with the body (effect.h) add a
// skew-symmetric part, which is included, at the cost of an LU factor, where steps without it
// converge slowly or not at all.
#ifndef LACUNA_FEM_NEWTON_H_
#define LACUNA_FEM_NEWTON_H_

#include <Eigen/Core>
#include <string>

#include "fem/block_matrix.h"
#include "fem/linear_solver.h"
#include "fem/newton_problem.h"

namespace lacuna {

struct NewtonSummary {
  enum class Status { kNotRun, kConverged, kNoConvergence, kLinearSolverFailed };
  Status status = Status::kNotRun;
  std::string message;  // why there is no convergence; empty where there is
  int iterations = 0;   // of both kinds
  double residual = 0;  // ‖r − applied‖∞ over the free components, N
  bool IsUsable() const { return status == Status::kConverged; }
};

// Starts at `*position` (3n, m). The held components are set to those of `target` (3n, m); a
// linearised iteration lets the others follow. `tangent` is used as working memory.
// On failure the summary says why, and `*position` is the last iterate.
NewtonSummary SolveByNewton(const NewtonProblem& problem, const Eigen::VectorXd& target,
                            LinearSolver* solver, BlockMatrix* tangent, Eigen::VectorXd* position);

}  // namespace lacuna

#endif  // LACUNA_FEM_NEWTON_H_
