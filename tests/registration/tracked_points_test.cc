// Source and target contain the same points, so that every error of the correspondence is known.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "registration/coherent_point_drift.h"
#include "registration/tracked_frames.h"

namespace lacuna {
namespace {

constexpr double kMillimetre = 1e-3;

// The options of experiments/rubber_strip.yaml.
CpdOptions TrackedOptions() {
  CpdOptions options;
  options.tangential_weight = 1.0;
  options.rigidity = 0.0;
  options.fine_variance = 0.0;
  options.match_extents = true;
  options.sigma_floor = 0.1;
  options.beta = 0.5;
  options.rank_tolerance = 1e-8;
  options.points_per_function = 1;
  options.max_rank = 200;
  return options;
}

struct FrameError {
  CorrespondenceError seen;
  double held_out = 0.0;  // rms, m
};

FrameError RegisterPair(int number, int hold_out_every) {
  char first[32], second[32];
  std::snprintf(first, sizeof(first), "points_%02d.csv", number);
  std::snprintf(second, sizeof(second), "points_%02d.csv", number + 1);
  const TrackedPair pair =
      MakeTrackedPair(ReadTrackedFrame(RubberStripFrames() / first),
                      ReadTrackedFrame(RubberStripFrames() / second), hold_out_every);
  const CpdResult result = RegisterNonrigid(pair.source, pair.target, TrackedOptions());
  EXPECT_TRUE(result.IsUsable()) << result.message;
  FrameError error;
  if (!result.IsUsable()) return error;
  error.seen = ErrorOf(pair, result.displaced);
  const Eigen::Matrix3Xd miss =
      pair.held_out + result.field.Evaluate(pair.held_out) - pair.held_out_target;
  if (miss.cols() > 0) error.held_out = std::sqrt(miss.colwise().squaredNorm().mean());
  return error;
}

class RubberStripTest : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(RubberStripFrames())) GTEST_SKIP() << "skipped, data absent";
  }
};

// One point is missing in one of frames 10 and 11, and one in one of frames 17 and 18.
constexpr int kPairs[] = {0, 5, 10, 17, 18};

// What bcpd -b1 -l5 -g0.1 -w0.1 was measured to leave: its largest rms over all 19 pairs
// (tests/benchmark/README.md).
constexpr double kPeerError = 0.0011 * kMillimetre;

TEST_F(RubberStripTest, FindsTheCorrespondenceAtLeastAsWellAsBcpd) {
  for (const int number : kPairs) {
    const FrameError error = RegisterPair(number, 5);
    EXPECT_LT(error.seen.rms, kPeerError) << "frame " << number;
    EXPECT_GT(error.seen.rms, 0.0) << "frame " << number;
    EXPECT_EQ(error.seen.mistaken, 0) << "frame " << number;
    // Points that it never saw are carried as well but for the noise of the measurement, 1 to 4 µm
    // in depth.
    EXPECT_LT(error.held_out, 0.003 * kMillimetre) << "frame " << number;
  }
}

// All points lie on a lattice of 0.7 mm that moves by 0.5 mm, so a motion in the opposite direction
// to the neighbouring lattice points explains the data nearly as well.
TEST_F(RubberStripTest, DoesNotMatchTheNeighbouringLatticePoints) {
  for (const int number : kPairs) {
    const FrameError error = RegisterPair(number, 0);
    EXPECT_LT(error.seen.rms, kPeerError) << "frame " << number;
    EXPECT_EQ(error.seen.mistaken, 0) << "frame " << number;
  }
}

// The same without measured data: the lattice of a sheet that moves by 0.6 of its spacing, is
// stretched by 2 % and bent.
TrackedPair MakeSheet() {
  constexpr int kAlong = 60, kAcross = 8;
  constexpr double kStep = 0.7 * kMillimetre;
  TrackedPair pair;
  pair.source.points.resize(3, kAlong * kAcross);
  pair.target.points.resize(3, kAlong * kAcross);
  for (int i = 0; i < kAlong * kAcross; ++i) {
    const double x = (i % kAlong - 0.5 * kAlong) * kStep, y = i / kAlong * kStep;
    pair.source.points.col(i) << x, y, 0.0;
    pair.target.points.col(i) << 1.02 * x + 0.6 * kStep, 0.99 * y, 1.0 * x * x;
    pair.source_row.push_back(i);
    pair.target_row.push_back(i);
  }
  return pair;
}

TEST(TrackedPointsTest, MatchedExtentsPreventAWrongMatchOfALattice) {
  const TrackedPair sheet = MakeSheet();
  CpdOptions options = TrackedOptions();
  const CpdResult matched = RegisterNonrigid(sheet.source, sheet.target, options);
  ASSERT_TRUE(matched.IsUsable()) << matched.message;
  // The motion is smooth and has no noise: the remaining error is due to the prior.
  EXPECT_LT(ErrorOf(sheet, matched.displaced).rms, 0.001 * kMillimetre);
  EXPECT_EQ(ErrorOf(sheet, matched.displaced).mistaken, 0);
  options.match_extents = false;
  const CpdResult in_place = RegisterNonrigid(sheet.source, sheet.target, options);
  EXPECT_GT(ErrorOf(sheet, in_place.displaced).mistaken, 100);
}

// Points at the cutoff of the Gaussians find their targets between two steps, so that an outdated
// Hessian would ruin the field.
TEST(TrackedPointsTest, PointsThatComeIntoReachDoNotRuinAFineBasis) {
  TrackedPair sheet = MakeSheet();
  for (int i = 20; i < 480; i += 40) sheet.source.points(2, i) += 0.29 * kMillimetre;
  const CpdResult result = RegisterNonrigid(sheet.source, sheet.target, TrackedOptions());
  ASSERT_TRUE(result.IsUsable()) << result.message;
  EXPECT_EQ(ErrorOf(sheet, result.displaced).mistaken, 0);
}

TEST(TrackedPointsTest, AFinerBasisDoesNoHarm) {
  const TrackedPair sheet = MakeSheet();
  CpdOptions options = TrackedOptions();
  options.beta = 1.0;
  double last = 1.0;
  for (const double tolerance : {1e-4, 1e-6, 1e-8, 1e-10}) {
    options.rank_tolerance = tolerance;
    const CpdResult result = RegisterNonrigid(sheet.source, sheet.target, options);
    ASSERT_TRUE(result.IsUsable()) << tolerance << ": " << result.message;
    const double rms = ErrorOf(sheet, result.displaced).rms;
    // The limit is the rounding error of single precision, 1e-7 times the size of 12 mm.
    EXPECT_LT(rms, std::max(1.1 * last, 1e-5 * kMillimetre)) << tolerance;
    last = rms;
  }
}

}  // namespace
}  // namespace lacuna
