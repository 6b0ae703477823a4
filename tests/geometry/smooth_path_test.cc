#include "geometry/smooth_path.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lacuna {
namespace {

// A path of one coordinate.
struct Path {
  std::vector<double> times, positions;

  double At(double time) const {
    return SmoothPath(times, [this](size_t k) { return positions[k]; }).At(time);
  }
  double VelocityBefore(double time) const { return (At(time) - At(time - kLittle)) / kLittle; }
  double VelocityAfter(double time) const { return (At(time + kLittle) - At(time)) / kLittle; }

  static constexpr double kLittle = 1e-7;
};

// Its velocities at the times 0, 1, 2 are 1, 1.5, 2.
const Path kFaster{{0, 1, 2}, {0, 1, 3}};

TEST(SmoothPath, PassesThroughItsPositionsWithoutAJumpOfItsVelocity) {
  EXPECT_EQ(kFaster.At(0), 0);
  EXPECT_EQ(kFaster.At(1), 1);
  EXPECT_EQ(kFaster.At(2), 3);
  // The mean of the positions at the ends plus an eighth of the difference of the velocities.
  EXPECT_DOUBLE_EQ(kFaster.At(0.5), 0.5 - 0.5 / 8);
  EXPECT_DOUBLE_EQ(kFaster.At(1.5), 2 - 0.5 / 8);
  EXPECT_NEAR(kFaster.VelocityBefore(1), 1.5, 1e-6);
  EXPECT_NEAR(kFaster.VelocityAfter(1), 1.5, 1e-6);
}

TEST(SmoothPath, TakesTheVelocityOfTheParabolaBetweenUnequalIntervals) {
  const Path path{{0, 1, 3}, {0, 1, 9}};  // the squares of the times
  EXPECT_NEAR(path.VelocityBefore(1), 2, 1e-6);
  EXPECT_NEAR(path.VelocityAfter(1), 2, 1e-6);
}

TEST(SmoothPath, RestsBeforeItsFirstTime) {
  EXPECT_EQ(kFaster.At(-0.001), 0);
  EXPECT_EQ(kFaster.At(-100), 0);
}

TEST(SmoothPath, GoesOnAfterItsLastTimeAsFarAsItCameBefore) {
  EXPECT_DOUBLE_EQ(kFaster.At(2.5), 6 - (2 - 0.5 / 8));
  EXPECT_DOUBLE_EQ(kFaster.At(3), 6 - 1);
  EXPECT_DOUBLE_EQ(kFaster.At(3.5), 6 - (0.5 - 0.5 / 8));
  EXPECT_NEAR(kFaster.VelocityBefore(2), 2, 1e-6);
  EXPECT_NEAR(kFaster.VelocityAfter(2), 2, 1e-6);
}

TEST(SmoothPath, GoesNoFartherThanItCame) {
  for (const double time : {4.0, 4.001, 1000.0}) EXPECT_EQ(kFaster.At(time), 6) << time;
}

TEST(SmoothPath, GoesOnEvenlyAfterAnEvenMotion) {
  const Path even{{1, 1.5, 3, 3.25}, {2, 3, 6, 6.5}};
  for (const double time : {3.3, 4.0, 5.5}) EXPECT_DOUBLE_EQ(even.At(time), 2 * time) << time;
}

TEST(SmoothPath, StaysAtRestForAsLongAsItHasRested) {
  const Path stopped{{0, 1, 2, 3, 4}, {0, 3, 5, 5, 5}};
  for (const double time : {4.25, 4.5, 5.0}) EXPECT_EQ(stopped.At(time), 5) << time;
}

// Along the straight line through the last two positions the error would be 1 + 2 · 8 = 17.
TEST(SmoothPath, DoesNotMagnifyErrorsOfCloseTimes) {
  Path noisy;
  for (int k = 0; k <= 10; ++k) {
    noisy.times.push_back(k);
    noisy.positions.push_back(k % 2 == 0 ? 1 : -1);
  }
  for (double s = 0.1; s <= 8; s += 0.1) EXPECT_LT(std::abs(noisy.At(10 + s)), 3.001) << s;
}

TEST(SmoothPath, RestsAtASinglePosition) {
  const Path single{{0.5}, {7}};
  for (const double time : {-1.0, 0.5, 0.6, 3.0}) EXPECT_EQ(single.At(time), 7) << time;
}

}  // namespace
}  // namespace lacuna
