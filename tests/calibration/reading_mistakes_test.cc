// Readings with a mistake, beside what a model predicts whose modulus has followed them.
#include "calibration/reading_mistakes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace lacuna {
namespace {

constexpr int kReadFrames = 21;
constexpr double kFrameTime = 0.1;  // s

// A force that rises after 0.5 s, N.
double TrueForce(double time) { return time < 0.5 ? 0 : std::pow(time - 0.5, 1.5); }

// What is found where the load cell reads this function of time and a model predicts `modulus`
// times the true force.
ReadingMistakes MistakesIn(const std::function<double(double)>& read, double modulus,
                           bool forces_are_known = false) {
  MeasuredReaction reading;
  reading.labels = {"x"};
  reading.directions = Eigen::Vector3d::UnitX();
  constexpr int kValues = 10 * (kReadFrames - 1) + 1;
  reading.times = Eigen::VectorXd::LinSpaced(kValues, 0, kFrameTime * (kReadFrames - 1));
  reading.values.resize(1, kValues);
  for (int k = 0; k < kValues; ++k) reading.values(0, k) = read(reading.times[k]);
  ReactionMisfit misfit;
  misfit.components = 1;
  misfit.residual.resize(kReadFrames);
  misfit.count.assign(kReadFrames, 1);
  std::vector<double> times;
  for (int f = 0; f < kReadFrames; ++f) {
    times.push_back(kFrameTime * f);
    misfit.residual[f] = modulus * TrueForce(times.back()) - read(times.back());
  }
  return FindReadingMistakes(reading, misfit, times, forces_are_known);
}

TEST(ReadingMistakes, AreTheSignOrAFactor) {
  const ReadingMistakes sign = MistakesIn([](double t) { return -TrueForce(t); }, 1e-4);
  ASSERT_TRUE(sign.factor);
  EXPECT_NEAR(*sign.factor, -1e4, 1);
  EXPECT_FALSE(sign.offset || sign.delay);
  const ReadingMistakes unit = MistakesIn([](double t) { return 1e3 * TrueForce(t); }, 1);
  ASSERT_TRUE(unit.factor);
  EXPECT_NEAR(*unit.factor, 1e3, 1e-6);
}

TEST(ReadingMistakes, AreAnOffset) {
  const ReadingMistakes found = MistakesIn([](double t) { return 0.5 + TrueForce(t); }, 1.3);
  EXPECT_FALSE(found.factor);
  ASSERT_TRUE(found.offset);
  EXPECT_NEAR(*found.offset, 0.5, 1e-9);
}

// The weights on the object are known, so that no modulus stands for the factor. In another unit,
// they differ from what the cell reads, beside the weight that it has not been told.
TEST(ReadingMistakes, AreNotAnOffsetAloneWhereKnownForcesAreInAnotherUnit) {
  const auto read = [](double t) { return 9.8 * TrueForce(t) - 2.5; };
  const ReadingMistakes known = MistakesIn(read, 1, /*forces_are_known=*/true);
  ASSERT_TRUE(known.factor && known.offset);
  EXPECT_NEAR(*known.factor, 9.8, 1e-9);
  EXPECT_NEAR(*known.offset, -2.5, 1e-9);
  EXPECT_FALSE(known.delay);
  const ReadingMistakes free = MistakesIn(read, 1);
  EXPECT_TRUE(free.offset && !free.factor) << "a modulus that is 9.8 times too small";
  const ReadingMistakes near_one = MistakesIn([](double t) { return 0.5 + TrueForce(t); }, 1.02,
                                              /*forces_are_known=*/true);
  ASSERT_TRUE(near_one.offset);
  EXPECT_NEAR(*near_one.offset, 0.5, 1e-9);
  EXPECT_FALSE(near_one.factor);
}

TEST(ReadingMistakes, AreADelayOfAboutTheKnownForces) {
  const auto late = [](double t) { return TrueForce(t - 0.2); };
  EXPECT_TRUE(MistakesIn(late, 1, /*forces_are_known=*/true).delay);
  EXPECT_FALSE(MistakesIn(late, 0.75, /*forces_are_known=*/true).delay);
  EXPECT_TRUE(MistakesIn(late, 0.75).delay);
}

TEST(ReadingMistakes, AreADelay) {
  const ReadingMistakes found = MistakesIn([](double t) { return TrueForce(t - 0.2); }, 0.75);
  EXPECT_FALSE(found.factor);
  ASSERT_TRUE(found.delay);
  EXPECT_NEAR(*found.delay, 0.2, 0.0126) << "half of the time between two delays that are tried";
}

TEST(ReadingMistakes, AreNotWhatAnotherForceLooksLike) {
  const ReadingMistakes found =
      MistakesIn([](double t) { return TrueForce(t) + std::sin(20 * t); }, 1);
  EXPECT_FALSE(found.factor || found.offset || found.delay);
  EXPECT_FALSE(MistakesIn(TrueForce, 0).factor) << "a model without a force";
}

}  // namespace
}  // namespace lacuna
