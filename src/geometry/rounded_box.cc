#include "geometry/rounded_box.h"

#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <tuple>
#include <vector>

namespace lacuna {
namespace {

// Grid coordinates along one side: dense enough over the two rounded ends (a quarter circle each)
// and even in between.
std::vector<double> SideCoordinates(double size, double radius, double edge_length) {
  std::vector<double> coordinates;
  const int arc =
      radius > 0
          ? std::max(2, static_cast<int>(std::ceil(0.5 * std::numbers::pi * radius / edge_length)))
          : 0;
  const double flat = size - 2 * radius;
  const int middle = flat > 0 ? std::max(1, static_cast<int>(std::round(flat / edge_length))) : 0;
  // A point of the box at depth t inside the rounded zone is pushed out along the direction from
  // the inner box; tangents of evenly spaced angles, up to the corner's 45°, give even arcs.
  for (int i = 0; i < arc; ++i)
    coordinates.push_back(-0.5 * flat -
                          radius * std::tan(0.25 * std::numbers::pi * (arc - i) / arc));
  for (int i = 0; i <= middle; ++i)
    coordinates.push_back(flat * (middle > 0 ? static_cast<double>(i) / middle - 0.5 : 0));
  for (int i = 1; i <= arc; ++i)
    coordinates.push_back(0.5 * flat + radius * std::tan(0.25 * std::numbers::pi * i / arc));
  return coordinates;
}

}  // namespace

TriMesh RoundedBox(const Eigen::Vector3d& centre, const Eigen::Vector3d& size, double edge_radius,
                   double edge_length) {
  CHECK(size.minCoeff() > 0 && edge_length > 0);
  CHECK(edge_radius >= 0 && 2 * edge_radius <= size.minCoeff());
  std::array<std::vector<double>, 3> coordinates;
  for (int axis = 0; axis < 3; ++axis)
    coordinates[axis] = SideCoordinates(size[axis], edge_radius, edge_length);
  const Eigen::Vector3d inner = 0.5 * size.array() - edge_radius;

  std::map<std::tuple<int, int, int>, int> number;  // vertex of each grid point on the surface
  std::vector<Eigen::Vector3d> vertices;
  const auto vertex = [&](const Eigen::Vector3i& index) {
    const auto [found, is_new] =
        number.try_emplace({index[0], index[1], index[2]}, static_cast<int>(vertices.size()));
    if (is_new) {
      Eigen::Vector3d point;
      for (int axis = 0; axis < 3; ++axis) point[axis] = coordinates[axis][index[axis]];
      const Eigen::Vector3d nearest = point.cwiseMax(-inner).cwiseMin(inner);
      const Eigen::Vector3d outward = point - nearest;
      if (edge_radius > 0) point = nearest + edge_radius * outward.normalized();
      vertices.push_back(centre + point);
    }
    return found->second;
  };

  std::vector<Eigen::Vector3i> triangles;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3;
    const int v = (axis + 2) % 3;
    for (const bool upper : {false, true}) {
      Eigen::Vector3i index;
      index[axis] = upper ? static_cast<int>(coordinates[axis].size()) - 1 : 0;
      for (int i = 0; i + 1 < static_cast<int>(coordinates[u].size()); ++i) {
        for (int j = 0; j + 1 < static_cast<int>(coordinates[v].size()); ++j) {
          const auto corner = [&](int di, int dj) {
            index[u] = i + di;
            index[v] = j + dj;
            return vertex(index);
          };
          const int a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          // Alternating diagonals avoid a preferred direction.
          std::array<Eigen::Vector3i, 2> pair{Eigen::Vector3i(a, b, c), Eigen::Vector3i(a, c, d)};
          if ((i + j) % 2 == 1) pair = {Eigen::Vector3i(a, b, d), Eigen::Vector3i(b, c, d)};
          for (Eigen::Vector3i& triangle : pair) {
            if (!upper) std::swap(triangle[1], triangle[2]);
            triangles.push_back(triangle);
          }
        }
      }
    }
  }
  TriMesh mesh{Eigen::Matrix3Xd(3, vertices.size()), Eigen::Matrix3Xi(3, triangles.size())};
  for (size_t i = 0; i < vertices.size(); ++i) mesh.vertices.col(i) = vertices[i];
  for (size_t i = 0; i < triangles.size(); ++i) mesh.triangles.col(i) = triangles[i];
  return mesh;
}

}  // namespace lacuna
