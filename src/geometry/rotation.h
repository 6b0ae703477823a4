// Rotations given by a vector: its direction is the axis, its length the angle.
#ifndef LACUNA_GEOMETRY_ROTATION_H_
#define LACUNA_GEOMETRY_ROTATION_H_

#include <Eigen/Geometry>

namespace lacuna {

// `vector`: rad; zero: no rotation.
inline Eigen::Matrix3d RotationBy(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_ROTATION_H_
