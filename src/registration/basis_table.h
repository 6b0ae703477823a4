// The kernel values of a basis at many points, and the two products with them that every iteration
// needs: coefficients → displacements, and forces → coefficients.
#ifndef LACUNA_REGISTRATION_BASIS_TABLE_H_
#define LACUNA_REGISTRATION_BASIS_TABLE_H_

#include <Eigen/Core>
#include <vector>

#include "registration/block_tree.h"
#include "registration/gaussian_basis.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// Holds k(p, y) rather than φ(y) = L⁻¹ k(p, y), in single precision: L is applied to the few
// coefficients, in double, instead of to the many points. That magnifies the rounding of k by
// 1/L_KK, so that a basis of fine tolerance is held as φ itself, which takes longer to fill in.
// Memory: 4 bytes × rank × points.
class BasisTable {
 public:
  // `points` in their places at construction; the basis and the kernels must outlive the table.
  BasisTable(const GaussianBasis& basis, const BlockTree& points, const GaussianKernels& kernels);

  // Σ_k c_k φ_k at the points: 3 × n, for coefficients 3 × K.
  Eigen::Matrix3Xf Expand(const Eigen::Matrix3Xd& coefficients) const;

  // Σ_i f_i φ_k(y_i): 3 × K, for forces 3 × n. Sums are formed in an order that depends on n alone.
  Eigen::Matrix3Xd Project(const Eigen::Matrix3Xf& forces) const;

 private:
  const LaneRow* Values(int64_t block) const { return values_.data() + block * rank_; }
  void FillWithKernels(const BlockTree& points);
  void FillWithFunctions(const BlockTree& points);

  const GaussianBasis& basis_;
  const GaussianKernels& kernels_;
  int size_ = 0;
  int rank_ = 0;
  bool holds_functions_ = false;
  std::vector<LaneRow> values_;  // rank rows per block of points
};

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_BASIS_TABLE_H_
