#include "fit/force_model.h"

#include <glog/logging.h>

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "fem/prescribed_force.h"

namespace lacuna {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

// A factor L with L Lᵀ ≈ exp(−d²/(2 ℓ²)) for the distances d between the points, one row per point.
// Columns are added until the remaining variance of every point is at most `tolerance`.
Eigen::MatrixXd PivotedCholesky(const Eigen::Matrix3Xd& points, double length, double tolerance) {
  const Eigen::Index count = points.cols();
  Eigen::VectorXd variance = Eigen::VectorXd::Ones(count);
  Eigen::MatrixXd factor(count, 0);
  Eigen::Index pivot = 0;
  while (factor.cols() < count && variance.maxCoeff(&pivot) > tolerance) {
    const Eigen::VectorXd squared = (points.colwise() - points.col(pivot)).colwise().squaredNorm();
    Eigen::VectorXd column = (squared.array() / (-2 * length * length)).exp();
    column -= factor * factor.row(pivot).transpose();
    column /= std::sqrt(variance[pivot]);
    factor.conservativeResize(Eigen::NoChange, factor.cols() + 1);
    factor.rightCols<1>() = column;
    variance -= column.cwiseAbs2();
  }
  return factor;
}

}  // namespace

bool ForceModel::HasFreeNodes() const {
  return std::any_of(free.begin(), free.end(), [](char is_free) { return is_free; });
}

ForceModel NoForces(const Body& body) {
  ForceModel model;
  model.free.assign(body.NodeCount(), 0);
  model.basis.resize(3 * body.NodeCount(), 0);
  return model;
}

ForceModel FreeForces(const Body& body, const Eigen::VectorXi& nodes) {
  ForceModel model = NoForces(body);
  for (const int node : nodes) model.free[node] = 1;
  return model;
}

ForceModel FootprintForce(const Body& body, const Eigen::VectorXi& nodes, double force_scale) {
  ForceModel model = NoForces(body);
  const Eigen::VectorXd share = BoundaryShares(body, nodes);
  Triplets entries;
  for (const int node : nodes)
    for (int k = 0; k < 3; ++k) entries.emplace_back(3 * node + k, k, force_scale * share[node]);
  model.basis.resize(3 * body.NodeCount(), 3);
  model.basis.setFromTriplets(entries.begin(), entries.end());
  return model;
}

ForceModel NodalForces(const Body& body, const Eigen::VectorXi& nodes, double force_scale) {
  ForceModel model = NoForces(body);
  Triplets entries;
  for (Eigen::Index i = 0; i < nodes.size(); ++i)
    for (int k = 0; k < 3; ++k) entries.emplace_back(3 * nodes[i] + k, 3 * i + k, force_scale);
  model.basis.resize(3 * body.NodeCount(), 3 * nodes.size());
  model.basis.setFromTriplets(entries.begin(), entries.end());
  return model;
}

ForceModel SmoothForces(const Body& body, const Eigen::VectorXi& nodes, double length,
                        double traction_scale) {
  CHECK_GT(length, 0);
  constexpr double kResidualVariance = 1e-3;
  ForceModel model = NoForces(body);
  const Eigen::VectorXd areas = NodeBoundaryAreas(body);
  const Eigen::Matrix3Xd points = body.mesh.nodes(Eigen::all, nodes);
  const Eigen::MatrixXd factor = PivotedCholesky(points, length, kResidualVariance);
  Triplets entries;
  entries.reserve(factor.size() * 3);
  for (Eigen::Index i = 0; i < nodes.size(); ++i)
    for (Eigen::Index mode = 0; mode < factor.cols(); ++mode)
      for (int k = 0; k < 3; ++k)
        entries.emplace_back(3 * nodes[i] + k, 3 * mode + k,
                             traction_scale * areas[nodes[i]] * factor(i, mode));
  model.basis.resize(3 * body.NodeCount(), 3 * factor.cols());
  model.basis.setFromTriplets(entries.begin(), entries.end());
  return model;
}

ForceModel HoldNetForceAndTorque(const Body& body, const ForceModel& model) {
  CHECK(!model.HasFreeNodes());
  const Eigen::Index count = model.CoefficientCount();
  if (count == 0) return model;
  const Eigen::Map<const Eigen::VectorXd> rest(body.mesh.nodes.data(), body.mesh.nodes.size());
  const Eigen::Vector3d centre = body.mesh.nodes.rowwise().mean();

  // Admissible coefficients form the null space of the map from coefficients to net force and
  // torque.
  Eigen::MatrixXd net(6, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const NetForce of_mode =
        NetForceOf(model.basis * Eigen::VectorXd::Unit(count, k), rest, centre);
    net.col(k) << of_mode.force, of_mode.torque;
  }
  const double lever = BoundingBoxDiagonal(body.mesh.nodes);
  net.bottomRows(3) /= lever;
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(net.transpose());
  qr.setThreshold(1e-10);
  const Eigen::MatrixXd q = qr.householderQ();
  ForceModel held = model;
  const Eigen::MatrixXd reduced = Eigen::MatrixXd(model.basis) * q.rightCols(count - qr.rank());
  held.basis = reduced.sparseView();
  return held;
}

Eigen::Vector3d NetForceDeviation(const ForceModel& model, const Eigen::MatrixXd& covariance) {
  CHECK_EQ(covariance.rows(), model.CoefficientCount());
  Eigen::MatrixXd net = Eigen::MatrixXd::Zero(3, model.CoefficientCount());
  for (Eigen::Index row = 0; row < model.basis.rows(); ++row)
    for (decltype(model.basis)::InnerIterator entry(model.basis, row); entry; ++entry)
      net(row % 3, entry.col()) += entry.value();
  return (net * covariance * net.transpose()).diagonal().cwiseSqrt();
}

NetForce NetForceOf(const Eigen::VectorXd& nodal_force, const Eigen::VectorXd& position,
                    const Eigen::Vector3d& centre) {
  NetForce net;
  for (Eigen::Index i = 0; i < nodal_force.size() / 3; ++i) {
    const Eigen::Vector3d force = nodal_force.segment<3>(3 * i);
    const Eigen::Vector3d arm = position.segment<3>(3 * i) - centre;
    net.force += force;
    net.torque += arm.cross(force);
  }
  return net;
}

}  // namespace lacuna
