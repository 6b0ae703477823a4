#include "geometry/surface_tracks.h"

#include <gtest/gtest.h>

#include <limits>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

// A point beside a box follows the box; a point that is not finite stays so.
TEST(SurfaceTracks, FollowTheSurfaceAndKeepMissingPointsMissing) {
  const TetMesh mesh = BoxMesh({0, 0, 0}, {2, 1, 1}, {2, 1, 1}, 1);
  const BoundarySurface boundary = ExtractBoundary(mesh);
  Eigen::Matrix3Xd points(3, 2);
  points.col(0) = Eigen::Vector3d(0.6, 0.4, 1.1);
  points.col(1).setConstant(std::numeric_limits<double>::quiet_NaN());
  const SurfaceTracks tracks = TrackOnSurface(boundary, points);
  const Eigen::Vector3d shift(0.3, -0.2, 0.1);
  const Eigen::Matrix3Xd moved = PointsAt(tracks, boundary, mesh.nodes.colwise() + shift);
  EXPECT_LT((moved.col(0) - points.col(0) - shift).norm(), 1e-12);
  EXPECT_TRUE(moved.col(1).array().isNaN().all());
}

}  // namespace
}  // namespace lacuna
