// A compact numbering of the vertices or nodes that are used.
#ifndef LACUNA_GEOMETRY_USED_INDICES_H_
#define LACUNA_GEOMETRY_USED_INDICES_H_

#include <Eigen/Core>
#include <cstddef>
#include <vector>

namespace lacuna {

struct UsedIndices {
  std::vector<int> used;    // the indices that are used, ascending
  std::vector<int> number;  // of each index, its place in `used`; −1: it is not used

  // The matrix with each index replaced by its number.
  Eigen::MatrixXi Renumbered(const Eigen::MatrixXi& indices) const {
    return indices.unaryExpr([this](int index) { return number[static_cast<size_t>(index)]; });
  }
};

// The indices from 0 to `count` − 1 that occur in a matrix, one of triangles or tetrahedra for
// instance.
inline UsedIndices FindUsedIndices(const Eigen::MatrixXi& indices, Eigen::Index count) {
  UsedIndices found;
  found.number.assign(static_cast<size_t>(count), -1);
  for (const int index : indices.reshaped()) found.number[static_cast<size_t>(index)] = 0;
  for (size_t index = 0; index < found.number.size(); ++index) {
    if (found.number[index] < 0) continue;
    found.number[index] = static_cast<int>(found.used.size());
    found.used.push_back(static_cast<int>(index));
  }
  return found;
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_USED_INDICES_H_
