#include "report/arrow_mesh.h"

#include <glog/logging.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace lacuna {
namespace {

constexpr int kSides = 8;

// Corners of a regular polygon about `centre`, perpendicular to `direction`.
void PlaceRing(const Eigen::Vector3d& centre, const Eigen::Vector3d& direction, double radius,
               Eigen::Index first, Eigen::Matrix3Xd* vertices) {
  const Eigen::Vector3d u = direction.unitOrthogonal();
  const Eigen::Vector3d v = direction.cross(u);
  for (int k = 0; k < kSides; ++k) {
    const double angle = 2 * std::numbers::pi * k / kSides;
    vertices->col(first + k) = centre + radius * (std::cos(angle) * u + std::sin(angle) * v);
  }
}

}  // namespace

TriMesh ArrowMesh(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& along, double radius) {
  static_assert(kArrowVertices == 3 * kSides + 1);
  CHECK_EQ(from.cols(), along.cols());
  constexpr double kConeRadius = 3, kConeLength = 7;  // multiples of the prism's radius
  constexpr int kTriangles = 4 * kSides;
  const Eigen::Index count = from.cols();
  TriMesh mesh{Eigen::Matrix3Xd(3, count * kArrowVertices),
               Eigen::Matrix3Xi(3, count * kTriangles)};
  Eigen::Index triangle = 0;
  for (Eigen::Index j = 0; j < count; ++j) {
    const double length = along.col(j).norm();
    const Eigen::Vector3d direction =
        length > 0 ? Eigen::Vector3d(along.col(j) / length) : Eigen::Vector3d::UnitZ();
    const double cone = std::min(length, kConeLength * radius);
    const double share = cone / (kConeLength * radius);
    const Eigen::Vector3d neck = from.col(j) + (length - cone) * direction;
    const Eigen::Index first = j * kArrowVertices;
    const double shaft = length > cone ? radius : 0;
    PlaceRing(from.col(j), direction, shaft, first, &mesh.vertices);
    PlaceRing(neck, direction, shaft, first + kSides, &mesh.vertices);
    PlaceRing(neck, direction, share * kConeRadius * radius, first + 2 * kSides, &mesh.vertices);
    const Eigen::Index tip = first + 3 * kSides;
    mesh.vertices.col(tip) = from.col(j) + along.col(j);
    for (int k = 0; k < kSides; ++k) {
      const auto at = [&](int ring, int side) {
        return static_cast<int>(first + ring * kSides + side % kSides);
      };
      const std::array<Eigen::Vector3i, 4> sides{
          Eigen::Vector3i(at(0, k), at(0, k + 1), at(1, k + 1)),
          Eigen::Vector3i(at(0, k), at(1, k + 1), at(1, k)),
          Eigen::Vector3i(at(2, k + 1), at(2, k), at(1, 0)),
          Eigen::Vector3i(at(2, k), at(2, k + 1), static_cast<int>(tip))};
      for (const Eigen::Vector3i& corners : sides) mesh.triangles.col(triangle++) = corners;
    }
  }
  return mesh;
}

}  // namespace lacuna
