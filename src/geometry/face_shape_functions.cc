#include "geometry/face_shape_functions.h"

namespace lacuna {

FaceShape<3> LinearFaceShape(const Eigen::Vector3d& barycentric) {
  return {barycentric, {-1, 1, 0}, {-1, 0, 1}};
}

FaceShape<6> QuadraticFaceShape(const Eigen::Vector3d& l) {
  FaceShape<6> shape;
  shape.value << l[0] * (2 * l[0] - 1), l[1] * (2 * l[1] - 1), l[2] * (2 * l[2] - 1),
      4 * l[0] * l[1], 4 * l[1] * l[2], 4 * l[2] * l[0];
  shape.by_first << 1 - 4 * l[0], 4 * l[1] - 1, 0, 4 * (l[0] - l[1]), 4 * l[2], -4 * l[2];
  shape.by_second << 1 - 4 * l[0], 0, 4 * l[2] - 1, -4 * l[1], 4 * l[1], 4 * (l[0] - l[2]);
  return shape;
}

Eigen::Matrix<double, 3, 6> FaceNodeCoordinates() {
  Eigen::Matrix<double, 3, 6> nodes = Eigen::Matrix<double, 3, 6>::Zero();
  for (int a = 0; a < 3; ++a) {
    nodes(a, a) = 1;
    nodes(a, 3 + a) = nodes((a + 1) % 3, 3 + a) = 0.5;
  }
  return nodes;
}

}  // namespace lacuna
