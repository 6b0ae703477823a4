#ifndef LACUNA_FEM_LARGEST_ENTRY_H_
#define LACUNA_FEM_LARGEST_ENTRY_H_

#include <Eigen/Core>

#include "fem/block_matrix.h"

namespace lacuna {

// The largest magnitude of an entry of the matrix; NaN if one of them is.
inline double LargestEntry(const BlockMatrix& matrix) {
  const Eigen::Index count = 9 * static_cast<Eigen::Index>(matrix.pattern().BlockCount());
  if (count == 0) return 0;
  return Eigen::Map<const Eigen::VectorXd>(matrix.values(), count)
      .cwiseAbs()
      .maxCoeff<Eigen::PropagateNaN>();
}

}  // namespace lacuna

#endif  // LACUNA_FEM_LARGEST_ENTRY_H_
