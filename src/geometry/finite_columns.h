// Points of which some are not known.
#ifndef LACUNA_GEOMETRY_FINITE_COLUMNS_H_
#define LACUNA_GEOMETRY_FINITE_COLUMNS_H_

#include <Eigen/Core>
#include <vector>

namespace lacuna {

// The columns of `points` (3 × n) without infinite entries and NaN, ascending.
inline std::vector<Eigen::Index> FiniteColumns(const Eigen::Matrix3Xd& points) {
  std::vector<Eigen::Index> finite;
  for (Eigen::Index j = 0; j < points.cols(); ++j)
    if (points.col(j).allFinite()) finite.push_back(j);
  return finite;
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_FINITE_COLUMNS_H_
