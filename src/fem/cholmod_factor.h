// A sparse Cholesky factorisation A = L Lᵀ in double precision, by the supernodal method of
// CHOLMOD.
//
// A is the part of a block matrix that belongs to the free nodes, in a given elimination order.
// Only one triangle of A is read, so A is taken to be symmetric. Solve() may be called by several
// threads at the same time, Factorise() not.
#ifndef LACUNA_FEM_CHOLMOD_FACTOR_H_
#define LACUNA_FEM_CHOLMOD_FACTOR_H_

#include <Eigen/Core>
#include <memory>

#include "fem/block_matrix.h"
#include "fem/elimination_order.h"

namespace lacuna {

class CholmodFactor {
 public:
  // Performs the symbolic analysis for all matrices of a pattern. No reference is kept.
  CholmodFactor(const BlockPattern& pattern, const EliminationOrder& order);
  ~CholmodFactor();
  CholmodFactor(CholmodFactor&&) noexcept;
  CholmodFactor& operator=(CholmodFactor&&) noexcept;

  // Computes the numeric factor. Returns false, and leaves no usable factor, if the matrix is not
  // positive definite on the free nodes or contains NaN. Throws OutOfMemory where the factor does
  // not fit into memory (core/memory_limit.h).
  bool Factorise(const BlockMatrix& matrix);

  // Solves L Lᵀ X = B for any number of columns. B and X have 3·(free nodes) rows in elimination
  // order. Needs a usable factor.
  void Solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::MatrixXd* X) const;

  double flops() const;    // floating-point operations of a numeric factorisation
  double entries() const;  // entries stored in L

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_CHOLMOD_FACTOR_H_
