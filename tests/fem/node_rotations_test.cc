#include "fem/node_rotations.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "core/parallel.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

Body Bar(int order) {
  const TetMesh mesh = BoxMesh({0, 0, 0}, {0.4, 0.1, 0.1}, {8, 2, 2});
  return MakeBody(order == 1 ? mesh : ToQuadratic(mesh), 1000);
}

template <typename Map>
Eigen::VectorXd Moved(const Body& body, const Map& map) {
  Eigen::VectorXd position(3 * body.NodeCount());
  for (int i = 0; i < body.NodeCount(); ++i) {
    position.segment<3>(3 * i) = map(Eigen::Vector3d(body.mesh.nodes.col(i)));
  }
  return position;
}

class NodeRotationsOfOrder : public testing::TestWithParam<int> {};

TEST_P(NodeRotationsOfOrder, AreTheRotationOfABodyThatIsAlsoStretchedAndTranslated) {
  const Body body = Bar(GetParam());
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Vector3d stretch(1.2, 0.9, 1.1);
  const Eigen::VectorXd position = Moved(body, [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return rotation * stretch.cwiseProduct(x) + Eigen::Vector3d(3, -2, 1);
  });
  for (const Eigen::Matrix3d& found : NodeRotations(body, position)) {
    // Rounding of positions at about 4 m from the origin, with elements of 0.05 m.
    EXPECT_LT((found - rotation).norm(), 1e-12);
  }
}

TEST_P(NodeRotationsOfOrder, FollowATwist) {
  const Body body = Bar(GetParam());
  const double twist = 3;  // rad/m
  const auto rotation_at = [&](double x) {
    return Eigen::AngleAxisd(twist * x, Eigen::Vector3d::UnitX()).toRotationMatrix();
  };
  const Eigen::VectorXd position = Moved(body, [&](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return rotation_at(x[0]) * (x - Eigen::Vector3d(0, 0.05, 0.05));
  });
  const std::vector<Eigen::Matrix3d> rotations = NodeRotations(body, position);
  for (int i = 0; i < body.NodeCount(); ++i) {
    // An element of 0.05 m spans 0.15 rad, and at surface nodes the shear is averaged on one side
    // only.
    EXPECT_LT((rotations[i] - rotation_at(body.mesh.nodes(0, i))).norm(), 0.3) << "node " << i;
  }
}

INSTANTIATE_TEST_SUITE_P(P, NodeRotationsOfOrder, testing::Values(1, 2));

TEST(NodeRotations, AreTheSameBitsOnOneAndTwoThreads) {
  const Body body = Bar(1);
  const Eigen::VectorXd position = Moved(body, [](const Eigen::Vector3d& x) -> Eigen::Vector3d {
    return x + Eigen::Vector3d(0, x[0] * x[0], x[1]);
  });
  const int threads = ThreadCount();
  SetThreadCount(1);
  const std::vector<Eigen::Matrix3d> on_one = NodeRotations(body, position);
  SetThreadCount(2);
  const std::vector<Eigen::Matrix3d> on_two = NodeRotations(body, position);
  SetThreadCount(threads);
  EXPECT_EQ(on_one, on_two);
}

}  // namespace
}  // namespace lacuna
