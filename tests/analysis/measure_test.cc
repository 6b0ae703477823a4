#include "analysis/measure.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lacuna {
namespace {

TEST(Measure, SummarisesLengthsWithoutUnmeasuredOnes) {
  const LengthSummary summary =
      Summarise(Eigen::Vector4d(3, std::numeric_limits<double>::quiet_NaN(), 4, 5));
  EXPECT_DOUBLE_EQ(summary.sum, 12);
  EXPECT_DOUBLE_EQ(summary.mean, 4);
  EXPECT_DOUBLE_EQ(summary.rms, std::sqrt(50.0 / 3));
  EXPECT_DOUBLE_EQ(summary.max, 5);
}

TEST(Measure, OfNoLengthsIsZero) {
  const LengthSummary summary = Summarise(Eigen::VectorXd());
  EXPECT_EQ(summary.sum, 0);
  EXPECT_EQ(summary.rms, 0);
}

TEST(Measure, AnimationResidualIsTheSumOverFrames) {
  EXPECT_DOUBLE_EQ(
      AnimationResidual({Summarise(Eigen::Vector2d(1, 2)), Summarise(Eigen::Vector2d(3, 4))}), 10);
}

TEST(Measure, DistanceToSurfaceNeedsNoCorrespondences) {
  TriMesh square;
  square.vertices.resize(3, 4);
  square.vertices.transpose() << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  square.triangles.resize(3, 2);
  square.triangles.transpose() << 0, 1, 2, 0, 2, 3;
  Eigen::Matrix3Xd points(3, 3);
  points.transpose() << 0.3, 0.4, 0.5,  // above
      0.5, 0.5, -0.1,                   // below
      1.3, 0.5, 0.4;                    // beside: distance 0.5
  const LengthSummary distance = DistanceToSurface(square, points);
  EXPECT_NEAR(distance.lengths[0], 0.5, 1e-12);
  EXPECT_NEAR(distance.lengths[1], 0.1, 1e-12);
  EXPECT_NEAR(distance.lengths[2], 0.5, 1e-12);
}

}  // namespace
}  // namespace lacuna
