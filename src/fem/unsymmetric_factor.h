// The LU factor of a tangent that is not symmetric or not definite, on the free components.
//
// It costs several times a Cholesky factor and is meant for steps in which no symmetric
// approximation serves: where a load that turns with the surface bends a body strongly, the skew
// part of the tangent is as large as the symmetric one.
#ifndef LACUNA_FEM_UNSYMMETRIC_FACTOR_H_
#define LACUNA_FEM_UNSYMMETRIC_FACTOR_H_

#include <Eigen/Core>
#include <Eigen/SparseLU>
#include <vector>

#include "fem/block_matrix.h"
#include "fem/held_components.h"

namespace lacuna {

class UnsymmetricFactor {
 public:
  // The factor of `symmetric` + `skew`; null: there is no skew part.
  UnsymmetricFactor(const HeldComponents& held, const BlockMatrix& symmetric,
                    const BlockMatrix* skew);

  bool IsUsable() const { return is_usable_; }  // false where the matrix is singular
  // The solutions for nodal vectors (3n × k); their held components are 0. CHECKs IsUsable().
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& right) const;

 private:
  std::vector<int> free_;  // the free components, ascending
  Eigen::SparseLU<Eigen::SparseMatrix<double>> factor_;
  bool is_usable_ = false;
};

}  // namespace lacuna

#endif  // LACUNA_FEM_UNSYMMETRIC_FACTOR_H_
