#include "effects/rest_region.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/tri_mesh.h"

namespace lacuna {

Eigen::VectorXd BumpAround(const Eigen::Vector3d& centre, double radius, const Body& body) {
  CHECK_GT(radius, 0);
  const Eigen::ArrayXd squared =
      (body.mesh.nodes.colwise() - centre).colwise().squaredNorm().transpose().array();
  return (-0.5 * squared / (radius * radius)).exp();
}

Eigen::VectorXd BumpShares(const Eigen::Vector3d& centre, double radius,
                           const Eigen::Matrix3Xd& places, const Eigen::VectorXd& measure) {
  CHECK_GT(radius, 0);
  CHECK_EQ(places.cols(), measure.size());
  const Eigen::ArrayXd squared =
      (places.colwise() - centre).colwise().squaredNorm().transpose().array();
  double nearest = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < squared.size(); ++i) {
    if (measure[i] > 0) nearest = std::min(nearest, squared[i]);
  }
  CHECK(std::isfinite(nearest)) << "no place has a measure";
  // A factor common to all, which keeps the nearest from underflow.
  Eigen::VectorXd share =
      measure.array() * (-0.5 * (squared - nearest).max(0) / (radius * radius)).exp();
  share = (share.array() < 1e-12 * share.maxCoeff()).select(0, share);
  return share / share.sum();
}

Eigen::VectorXd BumpShareDerivatives(int axis, double radius, const Eigen::Matrix3Xd& places,
                                     const Eigen::VectorXd& shares) {
  const Eigen::VectorXd along = places.row(axis);
  return shares.array() * (along.array() - shares.dot(along)) / (radius * radius);
}

Eigen::VectorXd NodeVolumes(const Body& body) { return body.node_mass / body.density; }

Eigen::VectorXd FacingAreas(const Eigen::Vector3d& direction, const Body& body) {
  if (direction.norm() == 0) return NodeBoundaryAreas(body);
  const TriMesh& surface = body.boundary.surface;
  const Eigen::VectorXd area = TriangleAreas(surface);
  const Eigen::VectorXd cosine = TriangleNormals(surface).transpose() * direction.normalized();
  Eigen::VectorXd facing = Eigen::VectorXd::Zero(body.NodeCount());
  for (Eigen::Index t = 0; t < surface.triangles.cols(); ++t) {
    if (cosine[t] <= 0) continue;
    const double u = std::clamp(2 * cosine[t] * cosine[t] - 0.5, 0.0, 1.0);
    for (const int corner : surface.triangles.col(t))
      facing[body.boundary.node[corner]] += u * u * (3 - 2 * u) * area[t] / 3;
  }
  return facing;
}

Eigen::VectorXd InHalfSpace(const Eigen::Vector3d& point, const Eigen::Vector3d& normal,
                            const Body& body) {
  if (normal.norm() == 0) return Eigen::VectorXd::Ones(body.NodeCount());
  const double rounding = 1e-9 * BoundingBoxDiagonal(body.mesh.nodes);
  const Eigen::ArrayXd height =
      ((body.mesh.nodes.colwise() - point).transpose() * normal.normalized()).array();
  return (height >= -rounding).cast<double>();
}

}  // namespace lacuna
