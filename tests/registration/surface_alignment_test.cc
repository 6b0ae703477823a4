#include "registration/surface_alignment.h"

#include <gtest/gtest.h>

#include "registration/warped_body.h"

namespace lacuna {
namespace {

TEST(SurfaceAlignmentTest, TheDisplacementMovesEachPointToItsPositionOnTheState) {
  const PointCloud points = SampleBody(800, 1);
  const PointCloud state = ScanOfWarpedBody(3000, 2);
  const Alignment alignment = Align(points, state);
  ASSERT_TRUE(alignment.IsUsable()) << alignment.message;
  const Eigen::Matrix3Xd truth = Warp(points.points) - points.points;
  // The remaining error is tangential motion, which the state does not show.
  EXPECT_LT(Rms(alignment.displacement - truth), 0.35 * Rms(truth));
  EXPECT_EQ(alignment.weight.size(), 800);
  // The 3000 points of the state are assigned to 800 points.
  EXPECT_NEAR(alignment.weight.mean(), 3000.0 / 800.0, 0.2);
  EXPECT_GT(alignment.standard_deviation.minCoeff(), 0.0);
}

TEST(SurfaceAlignmentTest, AFailureIsReported) {
  const Alignment alignment = Align(SampleBody(800, 1), {});
  EXPECT_EQ(alignment.status, CpdStatus::kTooFewPoints);
  EXPECT_FALSE(alignment.IsUsable());
  EXPECT_EQ(alignment.displacement.cols(), 0);
}

}  // namespace
}  // namespace lacuna
