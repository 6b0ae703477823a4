#include "geometry/tet_mesh.h"

#include <glog/logging.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "geometry/face_shape_functions.h"
#include "geometry/shape_functions.h"
#include "geometry/used_indices.h"

namespace lacuna {
namespace {

// One of the 6 m edges of the tetrahedra, with its position in that list. Sorting by the edge makes
// equal edges neighbours.
struct EdgePlace {
  uint64_t edge;
  int64_t place;
  bool operator<(const EdgePlace& other) const {
    return std::pair(edge, place) < std::pair(other.edge, other.place);
  }
};

std::vector<EdgePlace> SortedEdgePlaces(const Eigen::MatrixXi& tets) {
  std::vector<EdgePlace> places;
  places.reserve(6 * tets.cols());
  for (Eigen::Index e = 0; e < tets.cols(); ++e) {
    for (const auto& [i, j] : kTetEdges) {
      const auto [low, high] = std::minmax(tets(i, e), tets(j, e));
      const uint64_t edge = static_cast<uint64_t>(low) << 32 | static_cast<uint32_t>(high);
      places.push_back({edge, static_cast<int64_t>(places.size())});
    }
  }
  std::sort(places.begin(), places.end());
  return places;
}

struct FacePlace {
  std::array<int, 3> corners;  // ascending
  int64_t place;               // 4 · tet + face
  bool operator<(const FacePlace& other) const {
    return std::pair(corners, place) < std::pair(other.corners, other.place);
  }
};

// The faces (4 · tet + face) that belong to one tetrahedron only, ascending.
std::vector<int64_t> BoundaryPlaces(const Eigen::MatrixXi& tets) {
  std::vector<FacePlace> places;
  places.reserve(4 * tets.cols());
  for (Eigen::Index e = 0; e < tets.cols(); ++e) {
    for (const auto& face : kTetFaces) {
      std::array<int, 3> corners{tets(face[0], e), tets(face[1], e), tets(face[2], e)};
      std::sort(corners.begin(), corners.end());
      places.push_back({corners, static_cast<int64_t>(places.size())});
    }
  }
  std::sort(places.begin(), places.end());

  std::vector<int64_t> boundary;
  for (size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    while (end < places.size() && places[end].corners == places[begin].corners) ++end;
    if (end - begin == 1) boundary.push_back(places[begin].place);
  }
  std::sort(boundary.begin(), boundary.end());
  return boundary;
}

}  // namespace

Eigen::VectorXd TetVolumes(const TetMesh& mesh) {
  Eigen::VectorXd volumes(mesh.TetCount());
  for (Eigen::Index e = 0; e < volumes.size(); ++e) {
    const Eigen::Vector3d a = mesh.nodes.col(mesh.tets(0, e));
    const Eigen::Vector3d b = mesh.nodes.col(mesh.tets(1, e));
    const Eigen::Vector3d c = mesh.nodes.col(mesh.tets(2, e));
    const Eigen::Vector3d d = mesh.nodes.col(mesh.tets(3, e));
    volumes(e) = (b - a).cross(c - a).dot(d - a) / 6;
  }
  return volumes;
}

TetMesh ToQuadratic(const TetMesh& linear) {
  if (linear.Order() == 2) return linear;
  const std::vector<EdgePlace> places = SortedEdgePlaces(linear.tets);

  // Midpoints are numbered in the order of the first tetrahedron with the edge, so that nodes of
  // one element stay close in memory.
  std::vector<int64_t> first_place(places.size());
  for (size_t begin = 0, end = 0; begin < places.size(); begin = end) {
    for (; end < places.size() && places[end].edge == places[begin].edge; ++end) {
      first_place[places[end].place] = places[begin].place;
    }
  }
  TetMesh quadratic{{}, Eigen::MatrixXi(10, linear.TetCount())};
  quadratic.tets.topRows(4) = linear.tets;
  std::vector<Eigen::Vector3d> midpoints;
  for (size_t place = 0; place < first_place.size(); ++place) {
    const Eigen::Index e = place / 6, edge = place % 6;
    if (first_place[place] == static_cast<int64_t>(place)) {
      const auto& [i, j] = kTetEdges[edge];
      quadratic.tets(4 + edge, e) = static_cast<int>(linear.NodeCount() + midpoints.size());
      midpoints.push_back(
          0.5 * (linear.nodes.col(linear.tets(i, e)) + linear.nodes.col(linear.tets(j, e))));
    } else {
      const int64_t first = first_place[place];
      quadratic.tets(4 + edge, e) = quadratic.tets(4 + first % 6, first / 6);
    }
  }
  quadratic.nodes.resize(3, linear.NodeCount() + midpoints.size());
  quadratic.nodes.leftCols(linear.NodeCount()) = linear.nodes;
  for (size_t k = 0; k < midpoints.size(); ++k) {
    quadratic.nodes.col(linear.NodeCount() + k) = midpoints[k];
  }
  return quadratic;
}

BoundarySurface ExtractBoundary(const TetMesh& mesh) {
  const std::vector<int64_t> places = BoundaryPlaces(mesh.tets);
  const int nodes_per_face = mesh.Order() == 2 ? 6 : 3;
  const int triangles_per_face = mesh.Order() == 2 ? 4 : 1;

  BoundarySurface boundary;
  boundary.faces.resize(nodes_per_face, places.size());
  for (size_t f = 0; f < places.size(); ++f) {
    const auto& face = kTetFaces[places[f] % 4];
    for (int i = 0; i < nodes_per_face; ++i) {
      boundary.faces(i, f) = mesh.tets(face[i], places[f] / 4);
    }
  }

  const UsedIndices vertices = FindUsedIndices(boundary.faces, mesh.NodeCount());
  boundary.node = Eigen::Map<const Eigen::VectorXi>(vertices.used.data(), vertices.used.size());

  boundary.surface.triangles.resize(3, triangles_per_face * places.size());
  for (Eigen::Index f = 0; f < boundary.faces.cols(); ++f) {
    for (int quarter = 0; quarter < triangles_per_face; ++quarter) {
      for (int corner = 0; corner < 3; ++corner) {
        const int local = mesh.Order() == 2 ? kFaceQuarters[quarter][corner] : corner;
        boundary.surface.triangles(corner, triangles_per_face * f + quarter) =
            vertices.number[boundary.faces(local, f)];
      }
    }
  }
  boundary.surface.vertices = BoundaryAt(boundary, mesh.nodes).vertices;
  return boundary;
}

TriMesh BoundaryAt(const BoundarySurface& boundary, const Eigen::Matrix3Xd& nodes) {
  CHECK(boundary.node.size() == 0 || boundary.node.maxCoeff() < nodes.cols());
  return {nodes(Eigen::all, boundary.node), boundary.surface.triangles};
}

bool HasStraightEdges(const TetMesh& mesh, Eigen::Index tet) {
  if (mesh.Order() == 1) return true;
  constexpr double kRounding = 64 * std::numeric_limits<double>::epsilon();
  constexpr double kStraight = 1e-10;  // relative to the length of the edge
  for (size_t k = 0; k < kTetEdges.size(); ++k) {
    const Eigen::Vector3d a = mesh.nodes.col(mesh.tets(kTetEdges[k][0], tet));
    const Eigen::Vector3d b = mesh.nodes.col(mesh.tets(kTetEdges[k][1], tet));
    const Eigen::Vector3d midpoint = mesh.nodes.col(mesh.tets(4 + static_cast<int>(k), tet));
    const double largest = std::max(a.cwiseAbs().maxCoeff(), b.cwiseAbs().maxCoeff());
    const double allowed = kStraight * (b - a).norm() + kRounding * largest;
    if (!((midpoint - 0.5 * (a + b)).norm() <= allowed)) return false;
  }
  return true;
}

double VolumeOfCurvature(const TetMesh& mesh) {
  if (mesh.Order() == 1) return 0;
  // The determinant is of degree 3. The rule with the centroid and four points is exact for it
  // (Hammer & Stroud 1956).
  Eigen::Matrix<double, 4, 5> points = Eigen::Matrix<double, 4, 5>::Constant(1.0 / 6);
  points.leftCols<4>().diagonal().setConstant(0.5);
  points.col(4).setConstant(0.25);
  const Eigen::VectorXd of_corners = TetVolumes(mesh);
  double sum = 0;
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    if (HasStraightEdges(mesh, e)) continue;
    const Eigen::Matrix3Xd nodes = mesh.nodes(Eigen::all, mesh.tets.col(e));
    double volume = 0;
    for (int p = 0; p < 5; ++p) {
      const Eigen::Matrix3d jacobian = nodes * ShapeDerivativesAlongEdges(2, points.col(p));
      volume += (p < 4 ? 0.45 : -0.8) * jacobian.determinant() / 6;
    }
    sum += volume - of_corners(e);
  }
  return sum;
}

Eigen::Index FindFlatTet(const TetMesh& mesh) {
  constexpr double kFlat = 1e-14;  // relative to the cubed edge length
  constexpr double kRounding = 2 * std::numeric_limits<double>::epsilon();
  const Eigen::VectorXd volumes = TetVolumes(mesh);
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    double longest = 0;
    double largest = mesh.nodes.col(mesh.tets(0, e)).cwiseAbs().maxCoeff();
    for (int k = 1; k < 4; ++k) {
      const Eigen::Vector3d node = mesh.nodes.col(mesh.tets(k, e));
      longest = std::max(longest, (node - mesh.nodes.col(mesh.tets(0, e))).norm());
      largest = std::max(largest, node.cwiseAbs().maxCoeff());
    }
    const double square = longest * longest;
    if (std::abs(volumes(e)) <= kFlat * square * longest + kRounding * largest * square) return e;
  }
  return -1;
}

}  // namespace lacuna
