#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "geometry/median_split_tree.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;

constexpr int kQueriesPerTask = 256;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Triangle {
  Vector3d a, b, c;
  int index;  // index of the triangle in the mesh
  Eigen::AlignedBox3d Box() const { return Eigen::AlignedBox3d(a).extend(b).extend(c); }
  double Place(Eigen::Index axis) const { return a[axis] + b[axis] + c[axis]; }
};

std::vector<Triangle> TrianglesOf(const TriMesh& mesh) {
  std::vector<Triangle> triangles;
  triangles.reserve(mesh.triangles.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corners = mesh.triangles.col(t);
    triangles.push_back({mesh.vertices.col(corners(0)), mesh.vertices.col(corners(1)),
                         mesh.vertices.col(corners(2)), static_cast<int>(t)});
  }
  return triangles;
}

double SquaredDistance(const Eigen::AlignedBox3d& box, const Vector3d& query) {
  return (box.min() - query).cwiseMax(query - box.max()).cwiseMax(0).squaredNorm();
}

// The point on the segment from a to b that is nearest to the origin, as a fraction of the segment.
double NearestOnSegment(const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double squared_length = along.squaredNorm();
  return squared_length > 0 ? std::clamp(-a.dot(along) / squared_length, 0.0, 1.0) : 0.0;
}

// Barycentric coordinates of the point of triangle a, b, c that is nearest to the origin: the
// orthogonal projection if it lies inside, otherwise (and for slivers) the nearest point of an
// edge.
Vector3d NearestOnTriangle(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a);
  const Vector3d inside(normal.dot(b.cross(c)), normal.dot(c.cross(a)), normal.dot(a.cross(b)));
  if (inside.minCoeff() > 0) return inside / inside.sum();

  const double on_ab = NearestOnSegment(a, b);
  const double on_bc = NearestOnSegment(b, c);
  const double on_ca = NearestOnSegment(c, a);
  const double to_ab = (a + on_ab * (b - a)).squaredNorm();
  const double to_bc = (b + on_bc * (c - b)).squaredNorm();
  const double to_ca = (c + on_ca * (a - c)).squaredNorm();
  if (to_ab <= to_bc && to_ab <= to_ca) return {1 - on_ab, on_ab, 0};
  if (to_bc <= to_ca) return {0, 1 - on_bc, on_bc};
  return {on_ca, 0, 1 - on_ca};
}

struct Hit {
  double squared_distance = kInfinity;
  int triangle = -1;
  Vector3d barycentric = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
  Vector3d point = Vector3d::Constant(std::numeric_limits<double>::quiet_NaN());
};

// The lowest index wins among equally near triangles, whatever the order of traversal.
void Consider(const Triangle& t, const Vector3d& query, Hit* best) {
  const Vector3d barycentric = NearestOnTriangle(t.a - query, t.b - query, t.c - query);
  const Vector3d point = barycentric[0] * t.a + barycentric[1] * t.b + barycentric[2] * t.c;
  const double squared_distance = (point - query).squaredNorm();
  if (squared_distance < best->squared_distance ||
      (squared_distance == best->squared_distance && t.index < best->triangle)) {
    *best = {squared_distance, t.index, barycentric, point};
  }
}

}  // namespace

struct SurfaceSearch::Tree : MedianSplitTree<Triangle> {
  using MedianSplitTree::MedianSplitTree;

  Hit Nearest(const Vector3d& query) const {
    struct Visit {
      int node;
      double squared_distance;
    };
    std::array<Visit, 64> pending;  // one per level of a balanced tree
    int depth = 0;
    pending[depth++] = {0, 0};
    Hit best;
    while (depth > 0) {
      const Visit visit = pending[--depth];
      if (visit.squared_distance > best.squared_distance) continue;
      const Node& node = nodes()[visit.node];
      for (int i = node.begin; i < node.begin + node.count; ++i) {
        Consider(items()[i], query, &best);
      }
      if (node.count > 0) continue;
      Visit near{visit.node + 1, SquaredDistance(nodes()[visit.node + 1].box, query)};
      Visit far{node.right, SquaredDistance(nodes()[node.right].box, query)};
      if (far.squared_distance < near.squared_distance) std::swap(near, far);
      pending[depth++] = far;
      pending[depth++] = near;
    }
    return best;
  }
};

SurfaceSearch::SurfaceSearch(const TriMesh& mesh) {
  CHECK_GT(mesh.triangles.cols(), 0) << "there is no nearest point on an empty surface";
  tree_ = std::make_unique<Tree>(TrianglesOf(mesh));
}
SurfaceSearch::~SurfaceSearch() = default;
SurfaceSearch::SurfaceSearch(SurfaceSearch&&) noexcept = default;
SurfaceSearch& SurfaceSearch::operator=(SurfaceSearch&&) noexcept = default;

SurfaceHits SurfaceSearch::Nearest(const Eigen::Matrix3Xd& queries) const {
  const Eigen::Index count = queries.cols();
  SurfaceHits hits{Eigen::Matrix3Xd(3, count), Eigen::VectorXi(count), Eigen::Matrix3Xd(3, count),
                   Eigen::VectorXd(count)};
  ParallelFor(count, kQueriesPerTask, [&](int64_t i) {
    const Hit hit = tree_->Nearest(queries.col(i));
    hits.point.col(i) = hit.point;
    hits.triangle(i) = hit.triangle;
    hits.barycentric.col(i) = hit.barycentric;
    hits.distance(i) = std::sqrt(hit.squared_distance);
  });
  return hits;
}

}  // namespace lacuna
