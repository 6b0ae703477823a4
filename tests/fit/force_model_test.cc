#include "fit/force_model.h"

#include <gtest/gtest.h>

#include <array>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

Body SmallBar() {
  return MakeBody(BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d(0.1, 0.03, 0.03),
                          std::array<int, 3>{6, 2, 2}),
                  1000);
}

TEST(ForceModel, AFootprintDistributesOneForceByArea) {
  const Body body = SmallBar();
  const ForceModel model = FootprintForce(body, body.boundary.node, 2.0);
  ASSERT_EQ(model.CoefficientCount(), 3);
  const Eigen::VectorXd force = model.basis * Eigen::Vector3d(1, 0, -0.5);
  const Eigen::Map<const Eigen::VectorXd> rest(body.mesh.nodes.data(), body.mesh.nodes.size());
  const NetForce net = NetForceOf(force, rest, body.mesh.nodes.rowwise().mean());
  EXPECT_LT((net.force - Eigen::Vector3d(2, 0, -1)).norm(), 1e-12);
  // A uniform distribution over a symmetric body has no torque about its centre.
  EXPECT_LT(net.torque.norm(), 1e-3 * 2 * 0.1);
}

TEST(ForceModel, SmoothTractionsHaveTheGivenVarianceAndCorrelationLength) {
  const Body body = SmallBar();
  const double length = 0.03, scale = 100;
  const ForceModel model = SmoothForces(body, body.boundary.node, length, scale);
  const Eigen::VectorXd areas = VertexAreas(body.boundary.surface);
  const Eigen::MatrixXd covariance =
      Eigen::MatrixXd(model.basis) * Eigen::MatrixXd(model.basis).transpose();
  for (const auto& [a, b] : {std::pair{0, 0}, std::pair{0, 5}, std::pair{3, 20}}) {
    const double distance =
        (body.boundary.surface.vertices.col(a) - body.boundary.surface.vertices.col(b)).norm();
    const double expected = scale * scale * std::exp(-distance * distance / (2 * length * length));
    const double found =
        covariance(3 * body.boundary.node[a], 3 * body.boundary.node[b]) / (areas[a] * areas[b]);
    EXPECT_NEAR(found, expected, 2e-3 * scale * scale);  // the basis omits 0.1 % of the variance
  }
  EXPECT_LT(model.CoefficientCount(), 3 * body.boundary.node.size());
}

TEST(ForceModel, HeldFieldsHaveNoNetForceAndTorque) {
  const Body body = SmallBar();
  const ForceModel smooth = SmoothForces(body, body.boundary.node, 0.03, 1.0);
  const ForceModel held = HoldNetForceAndTorque(body, smooth);
  EXPECT_EQ(held.CoefficientCount(), smooth.CoefficientCount() - 6);
  const Eigen::Map<const Eigen::VectorXd> rest(body.mesh.nodes.data(), body.mesh.nodes.size());
  const Eigen::Vector3d centre(0.2, -0.1, 0);  // has no influence if the net force is 0
  for (Eigen::Index k = 0; k < held.CoefficientCount(); ++k) {
    const Eigen::VectorXd force = held.basis * Eigen::VectorXd::Unit(held.CoefficientCount(), k);
    EXPECT_GT(force.norm(), 0);
    const NetForce net = NetForceOf(force, rest, centre);
    EXPECT_LT(net.force.norm(), 1e-12 * force.lpNorm<1>());
    EXPECT_LT(net.torque.norm(), 1e-12 * force.lpNorm<1>());
  }
}

}  // namespace
}  // namespace lacuna
