// A cloud of points in space as a scanner produces it: unordered, with or without normals.
#ifndef LACUNA_GEOMETRY_POINT_CLOUD_H_
#define LACUNA_GEOMETRY_POINT_CLOUD_H_

#include <Eigen/Core>

namespace lacuna {

struct PointCloud {
  Eigen::Matrix3Xd points;   // 3 × n, m
  Eigen::Matrix3Xd normals;  // 3 × n, unit length, outward; 3 × 0 if unknown

  Eigen::Index Size() const { return points.cols(); }
  bool HasNormals() const { return Size() > 0 && normals.cols() == points.cols(); }
};

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_POINT_CLOUD_H_
