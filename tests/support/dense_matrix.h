// A block matrix as a dense one, to compare it with others entry by entry.
#ifndef LACUNA_TESTS_SUPPORT_DENSE_MATRIX_H_
#define LACUNA_TESTS_SUPPORT_DENSE_MATRIX_H_

#include <Eigen/Core>

#include "fem/block_matrix.h"

namespace lacuna {

inline Eigen::MatrixXd Dense(const BlockMatrix& matrix) {
  const BlockPattern& pattern = matrix.pattern();
  Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(3 * pattern.nodes, 3 * pattern.nodes);
  for (int i = 0; i < pattern.nodes; ++i)
    for (int k = pattern.row_begin[i]; k < pattern.row_begin[i + 1]; ++k)
      dense.block<3, 3>(3 * i, 3 * pattern.column[k]) = matrix.Block(k);
  return dense;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_DENSE_MATRIX_H_
