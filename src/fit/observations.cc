#include "fit/observations.h"

#include <glog/logging.h>

#include <cmath>
#include <vector>

#include "geometry/nearest.h"

namespace lacuna {
namespace {

constexpr double kMinNormalAgreement = 0.5;  // cos 60°: beyond it, the point is on another side
constexpr double kSmoothAgreement = 0.985;   // cos 10°: beyond it, there is an edge

Observations Allocate(Eigen::Index nodes, Eigen::Index count) {
  Observations observations;
  observations.node.resize(nodes, count);
  observations.weight.resize(nodes, count);
  observations.target.resize(3, count);
  observations.normal.resize(3, count);
  observations.normal_sigma.resize(count);
  observations.tangent_sigma.resize(count);
  return observations;
}

Observations Keep(const Observations& all, const std::vector<Eigen::Index>& kept) {
  Observations observations = Allocate(all.node.rows(), static_cast<Eigen::Index>(kept.size()));
  for (Eigen::Index j = 0; j < observations.Count(); ++j) {
    observations.node.col(j) = all.node.col(kept[j]);
    observations.weight.col(j) = all.weight.col(kept[j]);
    observations.target.col(j) = all.target.col(kept[j]);
    observations.normal.col(j) = all.normal.col(kept[j]);
    observations.normal_sigma[j] = all.normal_sigma[kept[j]];
    observations.tangent_sigma[j] = all.tangent_sigma[kept[j]];
  }
  return observations;
}

// Sets the mesh nodes and the weights of points that are given on triangles of the boundary.
void AttachToTriangles(const BoundarySurface& boundary, const SurfaceHits& hits,
                       Observations* observations) {
  for (Eigen::Index j = 0; j < hits.triangle.size(); ++j) {
    const Eigen::Vector3i triangle = boundary.surface.triangles.col(hits.triangle[j]);
    for (int a = 0; a < 3; ++a) observations->node(a, j) = boundary.node[triangle[a]];
    observations->weight.col(j) = hits.barycentric.col(j);
  }
}

// The normal at the nearest point of the boundary. Interpolated vertex normals (`smooth`) vary
// continuously, and so does the residual when the nearest triangle of a point changes. They can
// deviate far from the normal of the face near a sharp edge, and are not used there. On the edge
// itself, rounding decides which of its triangles is the nearest, so that `to_point`, from the
// nearest point to the scanned one, takes the place of the face's normal: the gradient of the
// distance. It has no direction for a point on the edge, whose residual is 0 with any normal.
Eigen::Vector3d NormalAt(const Eigen::Vector3d& smooth, const Eigen::Vector3d& face_normal,
                         double smallest_barycentric, const Eigen::Vector3d& to_point,
                         double sigma) {
  constexpr double kOnEdge = 1e-9;
  constexpr double kNoDistance = 1e-6;  // of the standard deviation
  Eigen::Vector3d sharp = face_normal;
  if (smallest_barycentric < kOnEdge) {
    if (to_point.norm() < kNoDistance * sigma) return smooth.normalized();
    sharp = to_point.normalized() * (to_point.dot(smooth) < 0 ? -1 : 1);
  }
  const bool is_smooth = smooth.norm() >= 0.5 && smooth.normalized().dot(sharp) >= kSmoothAgreement;
  return is_smooth ? smooth.normalized() : sharp;
}

}  // namespace

Eigen::Matrix<double, Eigen::Dynamic, 3> WhitenedDirections(const Observations& observations,
                                                            Eigen::Index j) {
  const Eigen::Vector3d normal = observations.normal.col(j);
  const bool normal_seen = std::isfinite(observations.normal_sigma[j]);
  const bool tangent_seen = std::isfinite(observations.tangent_sigma[j]);
  Eigen::Matrix<double, Eigen::Dynamic, 3> rows((normal_seen ? 1 : 0) + (tangent_seen ? 2 : 0), 3);
  int row = 0;
  if (normal_seen) rows.row(row++) = normal.transpose() / observations.normal_sigma[j];
  if (tangent_seen) {
    const Eigen::Vector3d first = normal.unitOrthogonal();
    rows.row(row++) = first.transpose() / observations.tangent_sigma[j];
    rows.row(row++) = normal.cross(first).transpose() / observations.tangent_sigma[j];
  }
  return rows;
}

Eigen::Vector3d Deviation(const Observations& observations, Eigen::Index j,
                          const Eigen::VectorXd& x) {
  Eigen::Vector3d deviation = -observations.target.col(j);
  for (Eigen::Index a = 0; a < observations.node.rows(); ++a)
    deviation += observations.weight(a, j) * x.segment<3>(3 * observations.node(a, j));
  return deviation;
}

Eigen::MatrixXd DeviationDerivative(const Observations& observations, Eigen::Index j,
                                    const Eigen::MatrixXd& x_by_p) {
  Eigen::MatrixXd derivative = Eigen::MatrixXd::Zero(3, x_by_p.cols());
  for (Eigen::Index a = 0; a < observations.node.rows(); ++a) {
    const double weight = observations.weight(a, j);
    if (weight != 0) derivative += weight * x_by_p.middleRows(3 * observations.node(a, j), 3);
  }
  return derivative;
}

Observations Concatenate(const Observations& first, const Observations& second) {
  CHECK_EQ(first.node.rows(), second.node.rows());
  Observations both = Allocate(first.node.rows(), first.Count() + second.Count());
  both.node << first.node, second.node;
  both.weight << first.weight, second.weight;
  both.target << first.target, second.target;
  both.normal << first.normal, second.normal;
  both.normal_sigma << first.normal_sigma, second.normal_sigma;
  both.tangent_sigma << first.tangent_sigma, second.tangent_sigma;
  return both;
}

Observations ObserveScan(const BoundarySurface& boundary, const Eigen::Matrix3Xd& x,
                         const PointCloud& scan, double sigma, double reach) {
  CHECK_GT(sigma, 0);
  CHECK(scan.points.allFinite());  // such a point has no nearest one
  const TriMesh surface = BoundaryAt(boundary, x);
  const SurfaceHits hits = SurfaceSearch(surface).Nearest(scan.points);
  const Eigen::Matrix3Xd face_normals = TriangleNormals(surface);
  const Eigen::Matrix3Xd vertex_normals = VertexNormals(surface);

  Observations all = Allocate(3, scan.Size());
  AttachToTriangles(boundary, hits, &all);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index j = 0; j < scan.Size(); ++j) {
    const Eigen::Vector3i triangle = surface.triangles.col(hits.triangle[j]);
    Eigen::Vector3d smooth = Eigen::Vector3d::Zero();
    for (int a = 0; a < 3; ++a) smooth += hits.barycentric(a, j) * vertex_normals.col(triangle[a]);
    const Eigen::Vector3d normal =
        NormalAt(smooth, face_normals.col(hits.triangle[j]), hits.barycentric.col(j).minCoeff(),
                 scan.points.col(j) - hits.point.col(j), sigma);

    all.target.col(j) = scan.points.col(j);
    all.normal.col(j) = normal;
    all.normal_sigma[j] = sigma;
    all.tangent_sigma[j] = kUnobserved;
    const bool faces_away =
        scan.HasNormals() && scan.normals.col(j).dot(normal) < kMinNormalAgreement;
    if (hits.distance[j] <= reach && !faces_away && normal.allFinite()) kept.push_back(j);
  }
  return Keep(all, kept);
}

Observations ObserveVertices(const BoundarySurface& boundary, const Eigen::Matrix3Xd& x,
                             const Eigen::Matrix3Xd& target, const Eigen::VectorXd& normal_sigma,
                             const Eigen::VectorXd& tangent_sigma) {
  CHECK_EQ(target.cols(), boundary.node.size());
  Observations all = Allocate(3, target.cols());
  all.normal = VertexNormals(BoundaryAt(boundary, x));
  all.target = target;
  all.normal_sigma = normal_sigma;
  all.tangent_sigma = tangent_sigma;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index j = 0; j < target.cols(); ++j) {
    all.node.col(j).setConstant(boundary.node[j]);
    all.weight.col(j) = Eigen::Vector3d::UnitX();
    const bool is_observed = std::isfinite(normal_sigma[j]) || std::isfinite(tangent_sigma[j]);
    if (is_observed && all.normal.col(j).norm() > 0.5) kept.push_back(j);
  }
  return Keep(all, kept);
}

Observations ObserveMarkers(const TetMesh& mesh, const Embedding& at_rest,
                            const Eigen::Matrix3Xd& target, double sigma) {
  CHECK_EQ(target.cols(), at_rest.tet.size());
  Observations all = Allocate(mesh.tets.rows(), target.cols());
  all.weight = at_rest.weight;
  all.target = target;
  all.normal = Eigen::Vector3d::UnitX().replicate(1, target.cols());
  all.normal_sigma.setConstant(sigma);
  all.tangent_sigma.setConstant(sigma);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index j = 0; j < target.cols(); ++j) {
    if (at_rest.tet[j] < 0 || !target.col(j).allFinite()) continue;
    all.node.col(j) = mesh.tets.col(at_rest.tet[j]);
    kept.push_back(j);
  }
  return Keep(all, kept);
}

}  // namespace lacuna
