// A Cholesky factor in double precision on the free components of a body, for any number of
// right-hand sides.
#ifndef LACUNA_FEM_FREE_COMPONENT_FACTOR_H_
#define LACUNA_FEM_FREE_COMPONENT_FACTOR_H_

#include <Eigen/Core>

#include "fem/block_matrix.h"
#include "fem/cholmod_factor.h"
#include "fem/elimination_order.h"
#include "fem/held_components.h"

namespace lacuna {

// Keeps the held components, the elimination order and the factor, which belong together: the order
// contains the nodes that are not held along all axes, and the factor is in that order and has the
// held components of the other nodes decoupled (held_components.h).
class FreeComponentFactor {
 public:
  // Performs the symbolic analysis for all matrices of a pattern. No reference is kept.
  FreeComponentFactor(const BlockPattern& pattern, HeldComponents held);

  const HeldComponents& held() const { return held_; }

  // Computes the numeric factor of a symmetric matrix A. Returns false, and leaves no usable
  // factor, if A is not positive definite on the free components or contains NaN. Throws
  // OutOfMemory where the factor does not fit into memory (core/memory_limit.h).
  bool Factorise(const BlockMatrix& A);

  // Solves A X = B for the free components. B and X have 3n rows, node-major; the held components
  // of B are not used, and those of X are 0. Needs a usable factor. May be called by several
  // threads at the same time.
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& B) const;

 private:
  HeldComponents held_;
  EliminationOrder order_;
  CholmodFactor factor_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_FREE_COMPONENT_FACTOR_H_
