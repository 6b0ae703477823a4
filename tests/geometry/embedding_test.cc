#include "geometry/embedding.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

#include "geometry/shape_functions.h"
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

TEST(Embedding, APointThatIsNotFiniteHasNoLocation) {
  const TetMesh mesh =
      BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), std::array<int, 3>{2, 2, 2});
  Eigen::Matrix3Xd points = Eigen::Vector3d(0.3, 0.61, 0.17).replicate(1, 2);
  points(1, 0) = std::nan("");
  const Embedding embedding = Embed(mesh, points);
  EXPECT_EQ(embedding.tet[0], -1);
  const Eigen::Matrix3Xd found = PointsAt(embedding, mesh, mesh.nodes);
  EXPECT_TRUE(found.col(0).array().isNaN().all());
  EXPECT_LT((found.col(1) - points.col(1)).norm(), 1e-12);
}

// A quarter of a thick-walled tube, whose elements have curved edges.
TetMesh Tube() {
  TetMesh mesh =
      BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), std::array<int, 3>{2, 3, 2}, 2);
  for (auto node : mesh.nodes.colwise()) {
    const double radius = 1 + node.x(), angle = 1.5 * node.y();
    node << radius * std::cos(angle), radius * std::sin(angle),
        node.z() + 0.2 * node.x() * node.x();
  }
  return mesh;
}

TEST(Embedding, SolvesForThePlaceInCurvedElements) {
  const TetMesh mesh = Tube();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(0.01, 1);
  Eigen::Matrix3Xd points(3, mesh.TetCount()), moved = points;
  Eigen::MatrixXd weight(10, mesh.TetCount());
  const Eigen::Matrix3Xd motion = mesh.nodes + Eigen::Matrix3Xd::Random(3, mesh.NodeCount());
  for (Eigen::Index e = 0; e < mesh.TetCount(); ++e) {
    Eigen::Vector4d at;
    for (double& x : at) x = uniform(random);
    weight.col(e) = ShapeValues(2, at / at.sum());
    points.col(e) = mesh.nodes(Eigen::all, mesh.tets.col(e)) * weight.col(e);
    moved.col(e) = motion(Eigen::all, mesh.tets.col(e)) * weight.col(e);
  }
  const Embedding embedding = Embed(mesh, points);
  EXPECT_EQ(embedding.outside.maxCoeff(), 0);
  EXPECT_EQ(embedding.tet,
            Eigen::VectorXi::LinSpaced(mesh.TetCount(), 0, static_cast<int>(mesh.TetCount()) - 1));
  // Rounding, of lengths of about 1.
  EXPECT_LT((embedding.weight - weight).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((PointsAt(embedding, mesh, mesh.nodes) - points).norm(), 1e-11);
  EXPECT_LT((PointsAt(embedding, mesh, motion) - moved).norm(), 1e-11);
  Eigen::Matrix3d turn;
  turn << 1, 0.2, 0, -0.3, 1.1, 0.4, 0.1, 0, 0.9;
  for (const int j : {0, 31, 71})
    EXPECT_LT((DeformationGradientAt(embedding, j, mesh, turn * mesh.nodes) - turn).norm(), 1e-11);
}

TEST(Embedding, ExtrapolatesFromCurvedElementsToPointsOutside) {
  const TetMesh mesh = Tube();
  Eigen::Matrix3Xd points(3, 3);
  points << 2.02, 0.97, 30, 0.1, 0.1, -20, 0.5, 0.5, 40;
  const Embedding embedding = Embed(mesh, points);
  EXPECT_GT(embedding.outside.minCoeff(), 0);
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    EXPECT_NEAR(embedding.weight.col(j).sum(), 1, 1e-9);
    // Rounding of weights far above 1.
    EXPECT_LT((PointsAt(embedding, mesh, mesh.nodes) - points).col(j).norm(), 1e-7);
  }
}

// The centroids of far more than the tried candidates are nearer to the point.
TEST(Embedding, FindsALargeTetrahedronBesideManySmallOnes) {
  TetMesh mesh = BoxMesh({-0.1, 0, 0}, {0, 0.1, 0.1}, std::array<int, 3>{5, 5, 5});
  const int small = static_cast<int>(mesh.TetCount());
  const int first = static_cast<int>(mesh.NodeCount());
  mesh.nodes.conservativeResize(3, first + 4);
  mesh.nodes.rightCols<4>() << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  mesh.tets.conservativeResize(4, small + 1);
  mesh.tets.rightCols<1>() << first, first + 1, first + 2, first + 3;
  const Embedding embedding = Embed(mesh, Eigen::Vector3d(1e-3, 0.05, 0.05));
  EXPECT_EQ(embedding.tet[0], small);
  EXPECT_EQ(embedding.outside[0], 0);
}

TEST(Embedding, FindsEveryInteriorPointOfAGradedMesh) {
  TetMesh mesh =
      BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), std::array<int, 3>{6, 6, 6});
  mesh.nodes = mesh.nodes.array().pow(5).matrix().eval();
  std::mt19937 random(9);
  std::uniform_real_distribution<double> inside(0.001, 0.999);
  Eigen::Matrix3Xd points(3, 500);
  for (double& x : points.reshaped()) x = std::pow(inside(random), 3);
  EXPECT_EQ(Embed(mesh, points).outside.maxCoeff(), 0);
}

TEST(Embedding, ReportsHowFarOutsideAPointIs) {
  const TetMesh mesh =
      BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), std::array<int, 3>{1, 1, 1});
  // In the tetrahedron that rises along z first, then x, then y, the barycentric coordinates are
  // 1 − z, z − x, x − y and y.
  EXPECT_NEAR(Embed(mesh, Eigen::Vector3d(0.5, 0.4, 1.2)).outside[0], 0.2, 1e-14);
}

}  // namespace
}  // namespace lacuna
