#include "fem/unsymmetric_factor.h"

#include <glog/logging.h>

namespace lacuna {

UnsymmetricFactor::UnsymmetricFactor(const HeldComponents& held, const BlockMatrix& symmetric,
                                     const BlockMatrix* skew) {
  const BlockPattern& pattern = symmetric.pattern();
  std::vector<int> place(static_cast<size_t>(3 * pattern.nodes), -1);  // among the free components
  for (int node = 0; node < pattern.nodes; ++node)
    for (int axis = 0; axis < 3; ++axis)
      if (!held.axes()[static_cast<size_t>(node)].Has(axis)) {
        place[static_cast<size_t>(3 * node + axis)] = static_cast<int>(free_.size());
        free_.push_back(3 * node + axis);
      }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * static_cast<size_t>(pattern.BlockCount()));
  for (int node = 0; node < pattern.nodes; ++node)
    for (int k = pattern.row_begin[static_cast<size_t>(node)];
         k < pattern.row_begin[static_cast<size_t>(node) + 1]; ++k) {
      Eigen::Matrix3d block = symmetric.Block(k);
      if (skew != nullptr) block += skew->Block(k);
      const int column = 3 * pattern.column[static_cast<size_t>(k)];
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
          const int to = place[static_cast<size_t>(3 * node + i)];
          const int from = place[static_cast<size_t>(column + j)];
          if (to >= 0 && from >= 0) entries.emplace_back(to, from, block(i, j));
        }
    }
  const Eigen::Index size = static_cast<Eigen::Index>(free_.size());
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  factor_.compute(matrix);
  is_usable_ = factor_.info() == Eigen::Success;
}

Eigen::MatrixXd UnsymmetricFactor::Solve(const Eigen::MatrixXd& right) const {
  CHECK(is_usable_);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(right.rows(), right.cols());
  if (free_.empty()) return all;
  const Eigen::MatrixXd of_free = right(free_, Eigen::all);
  const Eigen::MatrixXd solution = factor_.solve(of_free);
  all(free_, Eigen::all) = solution;
  return all;
}

}  // namespace lacuna
