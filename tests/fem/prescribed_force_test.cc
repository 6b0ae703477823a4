#include "fem/prescribed_force.h"

#include <gtest/gtest.h>

#include <cmath>

#include "effects/catalogue.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

TEST(PrescribedForce, IsDistributedByAreaAndFollowsItsHistory) {
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.03}, {3, 2, 2}, order), 1000);
    std::vector<int> tip;
    for (int i = 0; i < body.NodeCount(); ++i)
      if (body.mesh.nodes(0, i) > 0.1 - 1e-9) tip.push_back(i);
    const Eigen::VectorXi nodes =
        Eigen::Map<const Eigen::VectorXi>(tip.data(), static_cast<Eigen::Index>(tip.size()));
    const PrescribedForce force(BoundaryShares(body, nodes),
                                [](double time) { return Eigen::Vector3d(time, 0, -2 * time); });
    const Eigen::VectorXd position = body.mesh.nodes.reshaped();
    const Eigen::VectorXd velocity = Eigen::VectorXd::Zero(position.size()), state;
    Eigen::VectorXd total = Eigen::VectorXd::Zero(position.size());
    force.AddForce({body, position, velocity, velocity, 3.0, 0, state}, &total);
    const Eigen::Matrix3Xd at_nodes = total.reshaped(3, body.NodeCount());
    EXPECT_LT((at_nodes.rowwise().sum() - Eigen::Vector3d(3, 0, -6)).norm(), 1e-12);
    // A uniform distribution over the end acts at the centre of the face.
    const Eigen::Vector3d centre =
        body.mesh.nodes * at_nodes.row(2).transpose() / at_nodes.row(2).sum();
    EXPECT_LT((centre - Eigen::Vector3d(0.1, 0.015, 0.015)).norm(), 1e-12);
  }
}

// The nodal forces of a uniformly stretched bar at its end are those of a uniform traction.
TEST(BoundaryShares, AreThoseOfAUniformTraction) {
  constexpr double kModulus = 2e5, kStretch = 1e-3, kArea = 0.03 * 0.02;
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.02}, {3, 2, 2}, order), 1000);
    const Eigen::VectorXi end =
        NodesWhere(body.mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.1 - 1e-9; });
    Eigen::Matrix3Xd stretched = body.mesh.nodes;
    stretched.row(0) *= 1 + kStretch;
    const Eigen::VectorXd position = stretched.reshaped();
    const Eigen::VectorXd velocity = Eigen::VectorXd::Zero(position.size()), state;
    Eigen::VectorXd total = Eigen::VectorXd::Zero(position.size());
    MakeEffect("linear", {{"young_modulus", kModulus}, {"poisson_ratio", 0.0}})
        ->AddForce({body, position, velocity, velocity, 0, 0, state}, &total);
    const Eigen::VectorXd pull = -total.reshaped(3, body.NodeCount()).row(0).transpose();
    const Eigen::VectorXd share = BoundaryShares(body, end);
    EXPECT_LT((pull(end) - kModulus * kStretch * kArea * share(end)).norm(), 1e-10 * pull.norm());
    EXPECT_NEAR(share.sum(), share(end).sum(), 1e-15);
  }
}

// If the nodes end in the middle of quadratic faces, only the triangles that they span are loaded.
TEST(BoundaryShares, CoverPartsOfFaces) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.06, 0.02, 0.02}, {3, 1, 1}, 2), 1000);
  const auto on_top = [&](double from) {
    return NodesWhere(body.mesh, [from](const Eigen::Vector3d& at) {
      return at.z() > 0.02 - 1e-9 && at.x() > from - 1e-9;
    });
  };
  const auto middle = [&](const Eigen::VectorXd& share) { return body.mesh.nodes.row(0) * share; };
  EXPECT_NEAR(middle(BoundaryShares(body, on_top(0.04)))[0], 0.05, 1e-12);
  EXPECT_NEAR(middle(BoundaryShares(body, on_top(0.03)))[0], 0.045, 1e-3);
  // Corners that span no face.
  const Eigen::VectorXi corners = NodesWhere(body.mesh, [](const Eigen::Vector3d& at) {
    return at.x() < 1e-9 && std::abs(at.y() - 0.01) > 0.009 && std::abs(at.z() - 0.01) > 0.009;
  });
  ASSERT_EQ(corners.size(), 4);
  const Eigen::VectorXd share = BoundaryShares(body, corners);
  EXPECT_NEAR(share(corners).sum(), 1, 1e-12);
  EXPECT_GT(share(corners).minCoeff(), 0);
}

TEST(PrescribedForce, ItsEnergyAndGainAreThoseOfADeadLoad) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.03}, {3, 2, 2}, 1), 1000);
  const int nodes = body.NodeCount();
  const PrescribedForce of_gauge(
      BoundaryShares(body, Eigen::VectorXi::LinSpaced(nodes, 0, nodes - 1)),
      [](double time) { return Eigen::Vector3d(1 + time, 2, -3 * time); });
  const auto corrected = of_gauge.WithParameters(Eigen::VectorXd::Constant(1, 0.7));
  const Effect& force = *corrected;
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  const Eigen::VectorXd shift = 0.01 * Eigen::VectorXd::LinSpaced(rest.size(), -1, 1);
  const Eigen::VectorXd moved = rest + shift, velocity = Eigen::VectorXd::Zero(rest.size()), state;
  const Kinematics at{body, moved, velocity, velocity, 0.5, 0, state};
  Eigen::VectorXd acting = Eigen::VectorXd::Zero(rest.size()), per_gain = acting;
  force.AddForce(at, &acting);
  force.AddParameterDerivative(at, 0, &per_gain);
  EXPECT_LT((acting - 0.7 * per_gain).norm(), 1e-15);
  EXPECT_GT(acting.norm(), 0.1);
  EXPECT_NEAR(*force.Energy(at), -acting.dot(shift), 1e-15);
}

}  // namespace
}  // namespace lacuna
