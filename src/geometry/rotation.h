// Rotation vectors: the direction is the axis and the length is the angle.
#ifndef LACUNA_GEOMETRY_ROTATION_H_
#define LACUNA_GEOMETRY_ROTATION_H_

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace lacuna {

// The rotation matrix of a rotation vector (rad); the identity for the zero vector.
inline Eigen::Matrix3d RotationBy(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

// The angle, rad, of the rotation from one rotation vector to another. Beyond half a turn, where
// rotation vectors go on along the same axis, it is the difference of their lengths.
inline double AngleBetween(const Eigen::Vector3d& before, const Eigen::Vector3d& after) {
  const Eigen::Matrix3d turn = RotationBy(after) * RotationBy(before).transpose();
  return std::max(Eigen::AngleAxisd(turn).angle(), std::abs(after.norm() - before.norm()));
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_ROTATION_H_
