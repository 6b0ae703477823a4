// Rotation vectors: the direction is the axis and the length is the angle.
#ifndef LACUNA_GEOMETRY_ROTATION_H_
#define LACUNA_GEOMETRY_ROTATION_H_

#include <Eigen/Geometry>

namespace lacuna {

// The rotation matrix of a rotation vector (rad); the identity for the zero vector.
inline Eigen::Matrix3d RotationBy(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

}  // namespace lacuna

#endif  // LACUNA_GEOMETRY_ROTATION_H_
