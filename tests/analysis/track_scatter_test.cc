#include "analysis/track_scatter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

namespace lacuna {
namespace {

constexpr int kPoints = 8, kFrames = 300;
constexpr double kNoise = 1e-4;  // m

Eigen::VectorXd Times() { return Eigen::VectorXd::LinSpaced(kFrames, 0, 0.01 * (kFrames - 1)); }

// Points that swing by 20 mm, once in a hundred frames and one after the other.
Eigen::MatrixXd Swinging(double noise) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(
      3 * kPoints, kFrames, [&](Eigen::Index row, Eigen::Index frame) {
        return 0.02 * std::sin(0.02 * std::numbers::pi * static_cast<double>(frame) +
                               static_cast<double>(row / 3)) +
               noise * normal(random);
      });
}

TrackOutliers OutliersOf(const Eigen::MatrixXd& tracks) {
  return FindTrackOutliers(Times(), tracks, Eigen::VectorXd::Constant(tracks.rows() / 3, kNoise));
}

TEST(TrackScatter, NoiseIsFoundUnderSmoothMotion) {
  const TrackNoise noise = EstimateTrackNoise(Times(), Swinging(kNoise));
  // 24 rows of 300 frames determine it to 3 %, and the motion adds a few per cent.
  EXPECT_NEAR(noise.deviation, kNoise, 0.1 * kNoise);
  EXPECT_FALSE(noise.is_at_rest);
}

TEST(TrackScatter, SmoothMotionIsNone) {
  const TrackNoise noise = EstimateTrackNoise(Times(), Swinging(0));
  EXPECT_LT(noise.deviation, 1e-7);  // fourth differences of the swing: 20 mm (2π/100)⁴ / √70
  EXPECT_FALSE(noise.is_at_rest);
}

TEST(TrackScatter, MotionBetweenFewFramesIsABound) {
  const TrackNoise noise = EstimateTrackNoise(Times().head(5), Swinging(kNoise).leftCols(5));
  EXPECT_GT(noise.deviation, 0);
  EXPECT_FALSE(noise.is_at_rest);
  EXPECT_TRUE(std::isnan(EstimateTrackNoise(Times().head(2), Swinging(0).leftCols(2)).deviation));
}

TEST(TrackScatter, FramesBeforeTheMotionAreUsed) {
  Eigen::MatrixXd tracks = Swinging(kNoise);
  // A mean of frames would be still; the noise is that of other frames, and has the same size.
  const Eigen::MatrixXd noise = tracks - Swinging(0);
  for (int f = 0; f < 60; ++f) tracks.col(f) = Swinging(0).col(60) + noise.col(f);
  const TrackNoise found = EstimateTrackNoise(Times(), tracks);
  EXPECT_TRUE(found.is_at_rest);
  // 24 rows of 60 frames determine it to 2 %; motion at the end of the rest adds some.
  EXPECT_NEAR(found.deviation, kNoise, 0.15 * kNoise);
}

TEST(TrackScatter, PointsThatLeaveTheirTracksAreCounted) {
  Eigen::MatrixXd tracks = Swinging(kNoise);
  for (int k = 0; k < 17; ++k) tracks(3 * (k % kPoints), 10 + 15 * k) += 30 * kNoise;
  for (int point = 5; point < 8; ++point) tracks(3 * point + 1, 278) -= 30 * kNoise;
  const TrackOutliers outliers = OutliersOf(tracks);
  EXPECT_NEAR(outliers.share * kPoints * (kFrames - 4), 20, 0.1);
  EXPECT_EQ(outliers.worst_frame, 278);
  EXPECT_EQ(outliers.in_worst_frame, 3);
  // The difference from the cubic has the deviation √70/6 σ; three of these.
  EXPECT_NEAR(outliers.farthest, 30 * kNoise, 5 * kNoise);
}

TEST(TrackScatter, NoiseAndAJerkAreNoOutliers) {
  Eigen::MatrixXd tracks = Swinging(kNoise);
  EXPECT_EQ(OutliersOf(tracks).share, 0);
  // All points are released in the same frame, with different velocities.
  for (int row = 0; row < tracks.rows(); ++row)
    for (int f = 150; f < kFrames; ++f)
      tracks(row, f) += (0.5 + 0.125 * (row / 3)) * 50 * kNoise * (f - 150);
  EXPECT_EQ(OutliersOf(tracks).share, 0);
}

// A point of three that leaves its track is a third of the coordinates.
TEST(TrackScatter, FramesWithFewPointsAreNotJudged) {
  Eigen::MatrixXd tracks = Swinging(kNoise);
  tracks.col(100).head<3>().array() += 30 * kNoise;
  const TrackOutliers of_three = OutliersOf(tracks.topRows(3 * 3));
  EXPECT_TRUE(std::isnan(of_three.share));
  EXPECT_EQ(of_three.worst_frame, -1);
  const TrackOutliers of_five = OutliersOf(tracks.topRows(3 * 5));
  EXPECT_NEAR(of_five.share * 5 * (kFrames - 4), 1, 1e-6);  // but for rounding
  EXPECT_EQ(of_five.worst_frame, 100);
}

TEST(TrackScatter, OutliersAreJudgedByTheNoiseOfTheirPoint) {
  Eigen::MatrixXd tracks = Swinging(kNoise);
  tracks(0, 100) += 30 * kNoise;
  Eigen::VectorXd deviations = Eigen::VectorXd::Constant(kPoints, kNoise);
  EXPECT_GT(FindTrackOutliers(Times(), tracks, deviations).share, 0);
  deviations[0] *= 10;
  EXPECT_EQ(FindTrackOutliers(Times(), tracks, deviations).share, 0);
}

TEST(TrackScatter, UnevenTimesAreNotJudged) {
  // The points move steadily; frames 150 to 159 were lost.
  Eigen::VectorXd times = Times();
  times.tail(kFrames - 150).array() += 0.1;
  Eigen::MatrixXd tracks = Swinging(kNoise);
  tracks -= Swinging(0);
  for (int p = 0; p < kPoints; ++p)
    for (int f = 0; f < kFrames; ++f) tracks(3 * p, f) += (p == 0 ? 0.1 : 0.001) * times[f];
  const Eigen::VectorXd deviations = Eigen::VectorXd::Constant(kPoints, kNoise);
  EXPECT_EQ(FindTrackOutliers(times, tracks, deviations).share, 0);
  // Taken as equally spaced, the point that moves fast jumps by 10 mm.
  EXPECT_GT(FindTrackOutliers(Times(), tracks, deviations).share, 0);
}

TEST(TrackScatter, UnseenPointsAreLeftOut) {
  Eigen::MatrixXd tracks = Swinging(kNoise);
  tracks.middleRows<3>(6).setConstant(kUnknown);
  tracks.block(0, 40, 3, 30).setConstant(kUnknown);
  EXPECT_NEAR(EstimateTrackNoise(Times(), tracks).deviation, kNoise, 0.1 * kNoise);
  EXPECT_EQ(OutliersOf(tracks).share, 0);
}

}  // namespace
}  // namespace lacuna
