// A table of kernel values of a basis at many points, with the two products that every iteration of
// the registration needs: coefficients → displacements, and forces → coefficients.
#ifndef LACUNA_REGISTRATION_BASIS_TABLE_H_
#define LACUNA_REGISTRATION_BASIS_TABLE_H_

#include <Eigen/Core>
#include <vector>

#include "registration/block_tree.h"
#include "registration/gaussian_basis.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// The table stores k(p, y) in single precision rather than φ(y) = L⁻¹ k(p, y): L is applied in
// double precision to the few coefficients instead of to the many points. This magnifies the
// rounding error of k by 1/L_KK; a basis of fine tolerance (GaussianBasis::IsFine) is therefore
// stored as φ itself, which takes longer to compute. Memory: 4 bytes × rank × points.
class BasisTable {
 public:
  // Tabulates the basis at the present positions of `points`. The basis and the kernels must
  // outlive the table.
  BasisTable(const GaussianBasis& basis, const BlockTree& points, const GaussianKernels& kernels);

  // Returns u(y_i) = Σ_k c_k φ_k(y_i) (3 × n) for the coefficients c (3 × K).
  Eigen::Matrix3Xf Expand(const Eigen::Matrix3Xd& coefficients) const;

  // Returns Σ_i f_i φ_k(y_i) (3 × K) for the forces f (3 × n). The order of summation depends on n
  // only.
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
  std::vector<LaneRow> values_;  // rank_ rows for each block of points
};

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_BASIS_TABLE_H_
