#include "geometry/embedding.h"

#include <Eigen/LU>
#include <algorithm>
#include <limits>

#include "core/parallel.h"
#include "geometry/nearest.h"
#include "geometry/shape_functions.h"

namespace lacuna {
namespace {

// The number of tetrahedra with the nearest centroids that are tested. In a mesh of bounded quality
// one of them contains the point.
constexpr int kCandidates = 48;

// The matrix G (3 × 3, 1/m) with (ξ_1, ξ_2, ξ_3) = G (X − X_0) in a straight-edged tetrahedron.
Eigen::Matrix3d BarycentricGradient(const TetMesh& mesh, int tet) {
  Eigen::Matrix3d edges;
  for (int a = 0; a < 3; ++a)
    edges.col(a) = mesh.nodes.col(mesh.tets(a + 1, tet)) - mesh.nodes.col(mesh.tets(0, tet));
  return edges.inverse();
}

Eigen::Vector4d Barycentric(const TetMesh& mesh, int tet, const Eigen::Vector3d& point) {
  const Eigen::Vector3d inner =
      BarycentricGradient(mesh, tet) * (point - mesh.nodes.col(mesh.tets(0, tet)));
  return {1 - inner.sum(), inner[0], inner[1], inner[2]};
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
                      std::vector<Eigen::MatrixX3d>(static_cast<size_t>(points.cols())),
                      Eigen::VectorXd(points.cols())};
  ParallelFor(points.cols(), 256, [&](int64_t j) {
    double best = -std::numeric_limits<double>::infinity();
    Eigen::Vector4d inside;
    for (int k = 0; k < candidates; ++k) {
      const Eigen::Vector4d l = Barycentric(mesh, near.index(k, j), points.col(j));
      if (l.minCoeff() <= best) continue;
      best = l.minCoeff();
      embedding.tet[j] = near.index(k, j);
      inside = l;
    }
    embedding.weight.col(j) = ShapeValues(mesh.Order(), inside);
    Eigen::Matrix<double, 4, 3> by_place;
    by_place.bottomRows<3>() = BarycentricGradient(mesh, embedding.tet[j]);
    by_place.row(0) = -by_place.bottomRows<3>().colwise().sum();
    embedding.gradient[static_cast<size_t>(j)] = ShapeDerivatives(mesh.Order(), inside) * by_place;
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

Eigen::Matrix3d DeformationGradientAt(const Embedding& embedding, Eigen::Index j,
                                      const TetMesh& mesh,
                                      const Eigen::Ref<const Eigen::Matrix3Xd>& nodes) {
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();
  for (Eigen::Index a = 0; a < mesh.tets.rows(); ++a)
    gradient += nodes.col(mesh.tets(a, embedding.tet[j])) *
                embedding.gradient[static_cast<size_t>(j)].row(a);
  return gradient;
}

}  // namespace lacuna
