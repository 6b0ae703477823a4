#include "geometry/face_points.h"

#include <Eigen/Geometry>

namespace lacuna {
namespace {

// Barycentric coordinates in the whole face of the corners of its four triangles, in the order of
// BoundarySurface::surface.
constexpr double kQuarters[4][3][3] = {{{1, 0, 0}, {.5, .5, 0}, {.5, 0, .5}},
                                       {{.5, .5, 0}, {0, 1, 0}, {0, .5, .5}},
                                       {{.5, 0, .5}, {0, .5, .5}, {0, 0, 1}},
                                       {{.5, .5, 0}, {0, .5, .5}, {.5, 0, .5}}};

}  // namespace

FacePoint PlaceOnFace(const BoundarySurface& boundary, int triangle,
                      const Eigen::Vector3d& barycentric) {
  FacePoint point;
  point.weight.setZero();
  point.by_first.setZero();
  point.by_second.setZero();
  // The two coordinates of the face are l[1] and l[2], with l[0] = 1 − l[1] − l[2].
  constexpr double kFirst[3] = {-1, 1, 0}, kSecond[3] = {-1, 0, 1};
  if (boundary.faces.rows() == 3) {
    point.face = triangle;
    point.count = 3;
    point.weight.head<3>() = barycentric;
    for (int a = 0; a < 3; ++a) {
      point.by_first[a] = kFirst[a];
      point.by_second[a] = kSecond[a];
    }
    return point;
  }
  point.face = triangle / 4;
  point.count = 6;
  Eigen::Vector3d l = Eigen::Vector3d::Zero();
  for (int corner = 0; corner < 3; ++corner)
    for (int a = 0; a < 3; ++a) l[a] += barycentric[corner] * kQuarters[triangle % 4][corner][a];
  for (int a = 0; a < 3; ++a) {
    point.weight[a] = l[a] * (2 * l[a] - 1);
    point.by_first[a] = (4 * l[a] - 1) * kFirst[a];
    point.by_second[a] = (4 * l[a] - 1) * kSecond[a];
    const int b = (a + 1) % 3;  // the midpoint between a and b
    point.weight[3 + a] = 4 * l[a] * l[b];
    point.by_first[3 + a] = 4 * (l[a] * kFirst[b] + l[b] * kFirst[a]);
    point.by_second[3 + a] = 4 * (l[a] * kSecond[b] + l[b] * kSecond[a]);
  }
  return point;
}

FaceGeometry Evaluate(const FacePoint& point, const BoundarySurface& boundary,
                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes) {
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), first = position, second = position;
  for (int a = 0; a < point.count; ++a) {
    const Eigen::Vector3d node = nodes.col(boundary.faces(a, point.face));
    position += point.weight[a] * node;
    first += point.by_first[a] * node;
    second += point.by_second[a] * node;
  }
  const Eigen::Vector3d normal = first.cross(second);
  const double length = normal.norm();
  return {position, length > 0 ? Eigen::Vector3d(normal / length) : Eigen::Vector3d::Zero()};
}

}  // namespace lacuna
