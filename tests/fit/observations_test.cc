#include "fit/observations.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

struct Cube {
  TetMesh mesh =
      BoxMesh(Eigen::Vector3d::Zero(), Eigen::Vector3d::Ones(), std::array<int, 3>{2, 2, 2});
  BoundarySurface boundary = ExtractBoundary(mesh);
};

TEST(Observations, AScannedPointObservesTheNearestSurfaceAlongItsNormal) {
  const Cube cube;
  PointCloud scan;
  scan.points = Eigen::Vector3d(0.4, 0.3, 1.05);
  const Observations seen = ObserveScan(cube.boundary, cube.mesh.nodes, scan, 0.01, 0.1);
  ASSERT_EQ(seen.Count(), 1);
  EXPECT_LT((seen.normal.col(0) - Eigen::Vector3d::UnitZ()).norm(), 1e-12);
  EXPECT_TRUE(std::isinf(seen.tangent_sigma[0]));
  Eigen::Vector3d place = Eigen::Vector3d::Zero();
  for (int a = 0; a < 3; ++a) place += seen.weight(a, 0) * cube.mesh.nodes.col(seen.node(a, 0));
  EXPECT_LT((place - Eigen::Vector3d(0.4, 0.3, 1)).norm(), 1e-12);
}

// Two or three faces of the cube are equally near; the direction must not be that of one of them.
TEST(Observations, AScannedPointBeyondASharpEdgeObservesItAlongTheDistance) {
  const Cube cube;
  PointCloud scan;
  scan.points.resize(3, 3);
  scan.points.col(0) << 0.4, 1.04, 1.03;
  scan.points.col(1) << 1.02, 1.01, 1.02;
  scan.points.col(2) << 0.4, 1, 1;
  const Observations seen = ObserveScan(cube.boundary, cube.mesh.nodes, scan, 0.01, 0.1);
  ASSERT_EQ(seen.Count(), 3);
  EXPECT_LT((seen.normal.col(0) - Eigen::Vector3d(0, 0.8, 0.6)).norm(), 1e-9);
  EXPECT_LT((seen.normal.col(1) - Eigen::Vector3d(2, 1, 2) / 3).norm(), 1e-9);
  EXPECT_GT(seen.normal.col(2).tail<2>().minCoeff(), 0.3);
}

TEST(Observations, PointsOutOfReachOrFacingAwayObserveNothing) {
  const Cube cube;
  PointCloud scan;
  scan.points = Eigen::Vector3d(0.4, 0.3, 1.05);
  EXPECT_EQ(ObserveScan(cube.boundary, cube.mesh.nodes, scan, 0.01, 0.04).Count(), 0);
  scan.normals = -Eigen::Vector3d::UnitZ();
  EXPECT_EQ(ObserveScan(cube.boundary, cube.mesh.nodes, scan, 0.01, 0.1).Count(), 0);
}

TEST(Observations, AScanMustBeFinite) {
  const Cube cube;
  PointCloud scan;
  scan.points = Eigen::Vector3d(0.4, std::numeric_limits<double>::quiet_NaN(), 1.05);
  EXPECT_DEATH(ObserveScan(cube.boundary, cube.mesh.nodes, scan, 0.01, 0.1), "allFinite");
}

// Two vertices of the cube in the middle of faces; the others are not observed.
struct TwoVertices {
  TwoVertices() {
    const Eigen::Index count = cube.boundary.node.size();
    for (Eigen::Index j = 0; j < count; ++j) {
      const Eigen::Vector3d place = cube.mesh.nodes.col(cube.boundary.node[j]);
      if (place == Eigen::Vector3d(0.5, 0.5, 1)) top = j;
      if (place == Eigen::Vector3d(0.5, 0, 0.5)) front = j;
    }
    target = cube.mesh.nodes(Eigen::all, cube.boundary.node);
    target.col(top) += Eigen::Vector3d(0.2, 0.1, 0.3);
    Eigen::VectorXd normal_sigma = Eigen::VectorXd::Constant(count, kUnobserved);
    Eigen::VectorXd tangent_sigma = normal_sigma;
    normal_sigma[top] = 0.1;
    normal_sigma[front] = 0.01;
    tangent_sigma[front] = 0.02;
    seen = ObserveVertices(cube.boundary, cube.mesh.nodes, target, normal_sigma, tangent_sigma);
  }

  Cube cube;
  Eigen::Index top = -1, front = -1;
  Eigen::Matrix3Xd target;
  Observations seen;
};

TEST(Observations, AVertexIsObservedInTheDirectionsThatAreKnown) {
  const TwoVertices two;
  ASSERT_GE(std::min(two.top, two.front), 0);
  ASSERT_EQ(two.seen.Count(), 2);
  const Eigen::Map<const Eigen::VectorXd> at_rest(two.cube.mesh.nodes.data(),
                                                  two.cube.mesh.nodes.size());
  for (Eigen::Index j = 0; j < 2; ++j) {
    const bool is_top = (two.seen.node(0, j) == two.cube.boundary.node[two.top]);
    const Eigen::Index vertex = is_top ? two.top : two.front;
    EXPECT_EQ(two.seen.NodeCount(j), 1);
    EXPECT_EQ(two.seen.node(0, j), two.cube.boundary.node[vertex]);
    EXPECT_EQ(two.seen.target.col(j), two.target.col(vertex));
    EXPECT_EQ(WhitenedDirections(two.seen, j).rows(), is_top ? 1 : 3);
    const Eigen::Vector3d deviation = Deviation(two.seen, j, at_rest);
    EXPECT_LT((deviation - Eigen::Vector3d(is_top ? -0.2 : 0, is_top ? -0.1 : 0, is_top ? -0.3 : 0))
                  .norm(),
              1e-12);
    // The faces are flat around the vertices.
    const Eigen::VectorXd whitened = WhitenedDirections(two.seen, j) * deviation;
    EXPECT_NEAR(whitened.norm(), is_top ? 0.3 / 0.1 : 0, 1e-9);
  }
}

TEST(Observations, AMotionOfTheNodesMovesAnObservedPointByTheDerivative) {
  const Cube cube;
  PointCloud scan;
  scan.points = Eigen::Vector3d(0.4, 0.3, 1.05);
  const Observations seen = ObserveScan(cube.boundary, cube.mesh.nodes, scan, 0.01, 0.1);
  ASSERT_EQ(seen.Count(), 1);
  EXPECT_EQ(seen.NodeCount(0), 3);
  // Columns: a displacement of all nodes along x, and an extension along y.
  Eigen::MatrixXd moves = Eigen::MatrixXd::Zero(cube.mesh.nodes.size(), 2);
  for (Eigen::Index i = 0; i < cube.mesh.nodes.cols(); ++i) {
    moves(3 * i, 0) = 1;
    moves(3 * i + 1, 1) = cube.mesh.nodes(1, i);
  }
  Eigen::MatrixXd expected(3, 2);
  expected << 1, 0, 0, 0.3, 0, 0;
  EXPECT_LT((DeviationDerivative(seen, 0, moves) - expected).norm(), 1e-12);
}

TEST(Observations, ConcatenationKeepsTheOrder) {
  const TwoVertices two;
  PointCloud scan;
  scan.points = Eigen::Vector3d(0.4, 0.3, 1.05);
  const Observations scanned = ObserveScan(two.cube.boundary, two.cube.mesh.nodes, scan, 0.03, 0.1);
  ASSERT_EQ(scanned.Count(), 1);
  const Observations all = Concatenate(scanned, two.seen);
  ASSERT_EQ(all.Count(), 3);
  for (Eigen::Index j = 0; j < 3; ++j) {
    const Observations& source = j == 0 ? scanned : two.seen;
    const Eigen::Index of_source = j == 0 ? 0 : j - 1;
    EXPECT_EQ(all.node.col(j), source.node.col(of_source));
    EXPECT_EQ(all.weight.col(j), source.weight.col(of_source));
    EXPECT_EQ(all.target.col(j), source.target.col(of_source));
    EXPECT_EQ(all.normal.col(j), source.normal.col(of_source));
    EXPECT_EQ(all.normal_sigma[j], source.normal_sigma[of_source]);
    EXPECT_EQ(all.tangent_sigma[j], source.tangent_sigma[of_source]);
  }
}

TEST(Observations, AnUnseenMarkerObservesNothing) {
  const Cube cube;
  Eigen::Matrix3Xd places(3, 2);
  places << 0.2, 0.7, 0.2, 0.1, 1, 1;
  Eigen::Matrix3Xd target = places;
  target.col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  const Observations seen = ObserveMarkers(cube.mesh, Embed(cube.mesh, places), target, 0.01);
  ASSERT_EQ(seen.Count(), 1);
  EXPECT_EQ(seen.target.col(0), places.col(1));
}

TEST(Observations, AMarkerWhosePlaceAtRestIsUnknownObservesNothing) {
  const Cube cube;
  Eigen::Matrix3Xd places(3, 2);
  places << 0.2, 0.7, 0.2, 0.1, 1, 1;
  const Eigen::Matrix3Xd target = places;
  places.col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  const Observations seen = ObserveMarkers(cube.mesh, Embed(cube.mesh, places), target, 0.01);
  ASSERT_EQ(seen.Count(), 1);
  EXPECT_EQ(seen.target.col(0), target.col(1));
}

TEST(Observations, AMarkerBesideTheBodyTurnsWithIt) {
  const Cube cube;
  const Eigen::Vector3d place(0.4, 0.3, 1.2);
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 2) / 3).toRotationMatrix();
  const Observations seen = ObserveMarkers(cube.mesh, Embed(cube.mesh, place), turn * place, 0.01);
  ASSERT_EQ(seen.Count(), 1);
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  for (Eigen::Index a = 0; a < seen.node.rows(); ++a)
    point += seen.weight(a, 0) * (turn * cube.mesh.nodes.col(seen.node(a, 0)));
  EXPECT_LT((point - seen.target.col(0)).norm(), 1e-12);
}

}  // namespace
}  // namespace lacuna
