#include "fit/observations.h"

#include <gtest/gtest.h>

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

TEST(Observations, AnUnseenMarkerObservesNothing) {
  const Cube cube;
  Eigen::Matrix3Xd places(3, 2);
  places << 0.2, 0.7, 0.2, 0.1, 1, 1;
  const SurfaceHits at_rest = SurfaceSearch(cube.boundary.surface).Nearest(places);
  Eigen::Matrix3Xd target = places;
  target.col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  const Observations seen = ObserveMarkers(cube.boundary, at_rest, target, 0.01);
  ASSERT_EQ(seen.Count(), 1);
  EXPECT_EQ(seen.target.col(0), places.col(1));
}

TEST(Observations, AMarkerWhosePlaceAtRestIsUnknownObservesNothing) {
  const Cube cube;
  Eigen::Matrix3Xd places(3, 2);
  places << 0.2, 0.7, 0.2, 0.1, 1, 1;
  const Eigen::Matrix3Xd target = places;
  places.col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  const SurfaceHits at_rest = SurfaceSearch(cube.boundary.surface).Nearest(places);
  ASSERT_EQ(at_rest.triangle[0], -1);
  const Observations seen = ObserveMarkers(cube.boundary, at_rest, target, 0.01);
  ASSERT_EQ(seen.Count(), 1);
  EXPECT_EQ(seen.target.col(0), target.col(1));
}

}  // namespace
}  // namespace lacuna
