#include "geometry/embedding.h"

#include <gtest/gtest.h>

#include <array>
#include <random>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

TEST(Embedding, FollowsAnAffineMotionExactlyForBothOrders) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> inside(0.01, 0.99);
  Eigen::Matrix3Xd points(3, 50);
  for (double& x : points.reshaped()) x = inside(random);
  for (const int order : {1, 2}) {
    const TetMesh mesh = BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(),
                                 std::array<int, 3>{3, 4, 2}, order);
    const Embedding embedding = Embed(mesh, points);
    EXPECT_EQ(embedding.outside.maxCoeff(), 0);
    Eigen::Matrix3d turn;
    turn << 1, 0.2, 0, -0.3, 1.1, 0.4, 0.1, 0, 0.9;
    EXPECT_LT((PointsAt(embedding, mesh, turn * mesh.nodes) - turn * points).norm(), 1e-12);
    for (const int j : {0, 17, 49})
      EXPECT_LT((DeformationGradientAt(embedding, j, mesh, turn * mesh.nodes) - turn).norm(),
                1e-12);
  }
}

TEST(Embedding, FollowsAQuadraticMotionWithQuadraticElements) {
  const TetMesh mesh =
      BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), std::array<int, 3>{2, 2, 2}, 2);
  const Eigen::Vector3d point(0.3, 0.61, 0.17);
  Eigen::Matrix3Xd moved = mesh.nodes;
  moved.row(2) += mesh.nodes.row(0).cwiseProduct(mesh.nodes.row(1));
  const Embedding embedding = Embed(mesh, point);
  const Eigen::Vector3d found = PointsAt(embedding, mesh, moved);
  EXPECT_NEAR(found.z(), 0.17 + 0.3 * 0.61, 1e-12);
  Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity();
  gradient(2, 0) = 0.61;
  gradient(2, 1) = 0.3;
  EXPECT_LT((DeformationGradientAt(embedding, 0, mesh, moved) - gradient).norm(), 1e-12);
}

TEST(Embedding, ReportsHowFarOutsideAPointIs) {
  const TetMesh mesh =
      BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), std::array<int, 3>{1, 1, 1});
  EXPECT_GT(Embed(mesh, Eigen::Vector3d(0.5, 0.4, 1.2)).outside[0], 0.1);
}

}  // namespace
}  // namespace lacuna
