// CHOLMOD's supernodal Cholesky factor A = L Lᵀ of the free part of a block matrix, in double
// precision.
#ifndef LACUNA_FEM_CHOLMOD_FACTOR_H_
#define LACUNA_FEM_CHOLMOD_FACTOR_H_

#include <Eigen/Core>
#include <memory>

#include "fem/block_matrix.h"
#include "fem/elimination_order.h"

namespace lacuna {

class CholmodFactor {
 public:
  // Symbolic analysis for all matrices of one pattern. Both arguments are read here only.
  CholmodFactor(const BlockPattern& pattern, const EliminationOrder& order);
  ~CholmodFactor();
  CholmodFactor(CholmodFactor&&) noexcept;
  CholmodFactor& operator=(CholmodFactor&&) noexcept;

  // False when the matrix is not positive definite on the free nodes; there is no factor then.
  bool Factorise(const BlockMatrix& matrix);

  // Solves L Lᵀ X = B for any number of columns; rows are 3·(free nodes), in the elimination order.
  void Solve(const Eigen::Ref<const Eigen::MatrixXd>& B, Eigen::MatrixXd* X);

  double flops() const;    // of one numeric factorisation
  double entries() const;  // stored in L

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_CHOLMOD_FACTOR_H_
