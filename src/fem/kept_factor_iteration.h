// The solution of a time step with the factor of an earlier tangent.
//
// With a fixed factor M of a tangent, the steps −M⁻¹ r are combined by Anderson's mixing (D. G.
// Anderson, Journal of the ACM 12, 1965), here with the combination whose residual is smallest to
// first order in the norm of M⁻¹; for a linear equation this is the method of minimal residuals
// (H. F. Walker & P. Ni, SIAM Journal on Numerical Analysis 49, 2011). The present tangent is not
// assembled, so that a step of a smooth motion costs little more than a few residuals. The factor
// is renewed once where that is cheaper than to go on.
#ifndef LACUNA_FEM_KEPT_FACTOR_ITERATION_H_
#define LACUNA_FEM_KEPT_FACTOR_ITERATION_H_

#include <Eigen/Core>
#include <optional>

#include "fem/block_matrix.h"
#include "fem/linear_solver.h"
#include "fem/newton_problem.h"

namespace lacuna {

// The solution, from `start` (3n, m) with the held components of `target` (3n, m). No value where
// the residual does not fall in spite of a new factor, where the solver keeps no factors, and in
// statics, where a factor of a convexified tangent might lead to an unstable equilibrium. Adds the
// iterations that were made to `*iterations`. `tangent` is used as working memory.
std::optional<NewtonIterate> IterateWithKeptFactor(const NewtonProblem& problem,
                                                   const Eigen::VectorXd& target,
                                                   const Eigen::VectorXd& start,
                                                   LinearSolver* solver, BlockMatrix* tangent,
                                                   int* iterations);

}  // namespace lacuna

#endif  // LACUNA_FEM_KEPT_FACTOR_ITERATION_H_
