#include "geometry/embedding.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

// Tetrahedra whose centroid is near are tried; in a mesh of bounded quality one of so many contains
// the point.
constexpr int kCandidates = 48;

Eigen::Vector4d Barycentric(const TetMesh& mesh, int tet, const Eigen::Vector3d& point) {
  const Eigen::Vector3d origin = mesh.nodes.col(mesh.tets(0, tet));
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a) edges.col(a) = mesh.nodes.col(mesh.tets(a + 1, tet)) - origin;
  const Eigen::Vector3d inner = edges.inverse() * (point - origin);
  return {1 - inner.sum(), inner[0], inner[1], inner[2]};
}

Eigen::VectorXd ShapeFunctions(const Eigen::Vector4d& l, int order) {
  if (order == 1) return l;
  Eigen::VectorXd shape(10);
  for (int a = 0; a < 4; ++a) shape[a] = l[a] * (2 * l[a] - 1);
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (int e = 0; e < 6; ++e) shape[4 + e] = 4 * l[kEdges[e][0]] * l[kEdges[e][1]];
  return shape;
}

}  // namespace

Embedding Embed(const TetMesh& mesh, const Eigen::Matrix3Xd& points) {
  Eigen::Matrix3Xd centroids(3, mesh.TetCount());
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    centroids.col(e).setZero();
    for (int a = 0; a < 4; ++a) centroids.col(e) += 0.25 * mesh.nodes.col(mesh.tets(a, e));
  }
  const int candidates = static_cast<int>(std::min<Eigen::Index>(kCandidates, mesh.TetCount()));
  const PointHits near = PointSearch(centroids).Nearest(points, candidates);

  Embedding embedding{Eigen::VectorXi(points.cols()),
                      Eigen::MatrixXd(mesh.tets.rows(), points.cols()),
                      Eigen::VectorXd(points.cols())};
  ParallelFor(points.cols(), 256, [&](int64_t j) {
    double best = -std::numeric_limits<double>::infinity();
    for (int k = 0; k < candidates; ++k) {
      const Eigen::Vector4d l = Barycentric(mesh, near.index(k, j), points.col(j));
      if (l.minCoeff() <= best) continue;
      best = l.minCoeff();
      embedding.tet[j] = near.index(k, j);
      embedding.weight.col(j) = ShapeFunctions(l, mesh.Order());
    }
    embedding.outside[j] = std::max(0.0, -best);
  });
  return embedding;
}

Eigen::Matrix3Xd PointsAt(const Embedding& embedding, const TetMesh& mesh,
                          const Eigen::Matrix3Xd& nodes) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, embedding.tet.size());
  for (Eigen::Index j = 0; j < points.cols(); ++j)
    for (Eigen::Index a = 0; a < mesh.tets.rows(); ++a)
      points.col(j) += embedding.weight(a, j) * nodes.col(mesh.tets(a, embedding.tet[j]));
  return points;
}

}  // namespace lacuna
