#include "analysis/residual_statistics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "analysis/whiteness.h"

namespace lacuna {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Eigen::MatrixXd WhiteSeries(int rows, int columns, unsigned seed, double deviation = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, deviation);
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
}

// The autoregression x_f = a x_{f−1} + √(1 − a²) e_f with unit variance in every frame.
Eigen::MatrixXd AutoregressiveSeries(int rows, int columns, double a, unsigned seed) {
  Eigen::MatrixXd series = WhiteSeries(rows, columns, seed);
  for (int f = 1; f < columns; ++f)
    series.col(f) = a * series.col(f - 1) + std::sqrt(1 - a * a) * series.col(f);
  return series;
}

Eigen::Matrix3Xd PlacesInARow(int count, double spacing) {
  Eigen::Matrix3Xd places = Eigen::Matrix3Xd::Zero(3, count);
  for (int m = 0; m < count; ++m) places(0, m) = spacing * m;
  return places;
}

Eigen::VectorXd Times(int frames, double step) {
  return Eigen::VectorXd::LinSpaced(frames, 0, step * (frames - 1));
}

TEST(ResidualStatistics, RootMeanSquaresIgnoreUnseenEntries) {
  Eigen::MatrixXd vectors(6, 2);
  vectors.col(0) << 3, 4, 0, 0, 0, 1;
  vectors.col(1) << 0, kNan, 0, 0, 7, 0;
  const Eigen::MatrixXd lengths = PointLengths(vectors);
  EXPECT_DOUBLE_EQ(lengths(0, 0), 5);
  EXPECT_TRUE(std::isnan(lengths(0, 1)));
  EXPECT_DOUBLE_EQ(Rms(lengths), 5);  // √((25 + 1 + 49)/3)
  EXPECT_DOUBLE_EQ(RmsOfPoints(lengths)[0], 5);
  EXPECT_DOUBLE_EQ(RmsOfPoints(lengths)[1], 5);
  EXPECT_DOUBLE_EQ(RmsOfFrames(lengths)[0], std::sqrt(13.0));
  EXPECT_DOUBLE_EQ(RmsOfFrames(lengths)[1], 7);
  EXPECT_TRUE(std::isnan(Rms(Eigen::MatrixXd::Constant(1, 1, kNan))));
}

TEST(ResidualStatistics, ChiSquareTailsAgreeWithTables) {
  // 5 % points to three decimals (Abramowitz & Stegun, table 26.8), i.e. with errors below 1e-4 in
  // p.
  EXPECT_NEAR(ChiSquareTail(3.841, 1), 0.05, 1e-4);
  EXPECT_NEAR(ChiSquareTail(5.991, 2), 0.05, 1e-4);
  EXPECT_NEAR(ChiSquareTail(7.815, 3), 0.05, 1e-4);
  EXPECT_NEAR(ChiSquareTail(18.307, 10), 0.05, 1e-4);
  EXPECT_NEAR(ChiSquareTail(124.342, 100), 0.05, 1e-4);
  // For many degrees of freedom k nearly normal, with mean k, variance 2k and a skewness below
  // 0.01.
  EXPECT_NEAR(ChiSquareTail(5000, 5000), 0.5, 0.01);
  EXPECT_EQ(ChiSquareTail(0, 3), 1);
  for (const int freedom : {1, 2, 3})
    EXPECT_EQ(ChiSquareTail(std::numeric_limits<double>::infinity(), freedom), 0);
}

TEST(ResidualStatistics, WhiteNoiseIsRejectedAtTheNominalRate) {
  constexpr unsigned kSeeds = 400, kSpaceSeeds = 100;
  int in_time = 0, in_space = 0;
  const Eigen::Matrix3Xd places = PlacesInARow(4, 0.01);
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const Eigen::MatrixXd noise = WhiteSeries(12, 100, seed);
    in_time += WhitenessInTime(noise).p_value < 0.05;
    if (seed < kSpaceSeeds) in_space += WhitenessInSpace(noise, places).p_value < 0.05;
  }
  // 5 % of 400 is 20 ± 4.4, of 100 it is 5 ± 2.2; three standard deviations.
  EXPECT_NEAR(in_time, 20, 14);
  EXPECT_LT(in_space, 12);
}

TEST(ResidualStatistics, PointsWithCommonNoiseAreStillWhiteInTime) {
  int coloured = 0;
  for (unsigned seed = 0; seed < 200; ++seed)
    coloured += WhitenessInTime(WhiteSeries(3, 60, seed).replicate(4, 1)).p_value < 0.05;
  EXPECT_LT(coloured, 20);  // 10 ± 3
}

TEST(ResidualStatistics, IndependentPointsWithAutocorrelationAreNotCalledCorrelated) {
  const Eigen::Matrix3Xd places = PlacesInARow(20, 0.01);
  int related = 0;
  for (unsigned seed = 0; seed < 40; ++seed)
    related += WhitenessInSpace(AutoregressiveSeries(60, 100, 0.8, seed), places).p_value < 0.05;
  // 3 ± 1.7 are expected. A χ² distribution with Bartlett's effective number of frames would give
  // 10.
  EXPECT_LT(related, 8);
}

// A patch moves along its normal only: its three coordinates are one number.
TEST(ResidualStatistics, PatchesAreTestedByOneNumberEach) {
  const Eigen::Matrix3Xd places = PlacesInARow(6, 0.01);
  int related = 0;
  for (unsigned seed = 0; seed < 100; ++seed)
    related += WhitenessInSpace(WhiteSeries(6, 60, seed), places).p_value < 0.05;
  EXPECT_LT(related, 12);  // 5 ± 2.2
  Eigen::MatrixXd common = WhiteSeries(6, 60, 3);
  common.rowwise() += 0.7 * WhiteSeries(1, 60, 4).row(0);
  const SpaceWhiteness whiteness = WhitenessInSpace(common, places);
  EXPECT_LE(whiteness.p_value, 0.005);
  EXPECT_NEAR(whiteness.mean_correlation, 0.49 / 1.49, 0.2);  // about two standard deviations
}

TEST(ResidualStatistics, AutoregressionIsDetectedWithItsCorrelationTime) {
  const TimeWhiteness white = WhitenessInTime(WhiteSeries(6, 400, 1));
  const TimeWhiteness coloured = WhitenessInTime(AutoregressiveSeries(6, 400, 0.8, 1));
  EXPECT_EQ(coloured.lags, 10);
  EXPECT_LE(coloured.p_value, 0.001);  // the smallest possible with a thousand orders
  EXPECT_GT(white.p_value, 0.01);
  // The standard deviation of ρ_1 is √((1 − a²)/n) = 0.012 for 2400 entries.
  EXPECT_NEAR(coloured.lag_one, 0.8, 0.05);
  EXPECT_NEAR(white.lag_one, 0, 0.08);
  EXPECT_NEAR(coloured.correlation_frames, -1 / std::log(0.8), 1);  // 4.5
  EXPECT_LT(white.correlation_frames, 1);
}

TEST(ResidualStatistics, WeakAutoregressionIsUsuallyDetected) {
  int found = 0;
  for (unsigned seed = 0; seed < 100; ++seed)
    found += WhitenessInTime(AutoregressiveSeries(6, 200, 0.4, seed)).p_value < 0.05;
  EXPECT_GE(found, 95);
}

TEST(ResidualStatistics, GapsDoNotMakeNoiseColoured) {
  int coloured = 0;
  for (unsigned seed = 0; seed < 200; ++seed) {
    Eigen::MatrixXd noise = WhiteSeries(3, 120, seed);
    for (int f = 0; f < 120; ++f)
      if (f % 7 == 0 || (f > 40 && f < 60)) noise.col(f).setConstant(kNan);
    coloured += WhitenessInTime(noise).p_value < 0.05;
  }
  EXPECT_LT(coloured, 24);  // 10 ± 3
}

TEST(ResidualStatistics, TooFewFramesGiveNoResult) {
  const TimeWhiteness whiteness = WhitenessInTime(WhiteSeries(3, 9, 1));
  EXPECT_EQ(whiteness.lags, 0);
  EXPECT_TRUE(std::isnan(whiteness.p_value));
  EXPECT_TRUE(
      std::isnan(WhitenessInSpace(WhiteSeries(6, 5, 1), PlacesInARow(2, 1)).mean_correlation));
  EXPECT_TRUE(std::isnan(WhiteNoise(Eigen::MatrixXd::Zero(3, 2))));
}

TEST(ResidualStatistics, CorrelationLengthInSpaceIsRecovered) {
  constexpr int kPoints = 6, kFrames = 2000;
  constexpr double kLength = 0.03;
  const Eigen::Matrix3Xd places = PlacesInARow(kPoints, 0.01);
  // Along a row of points, the correlation exp(−d/ℓ) is an autoregression from point to point.
  const double a = std::exp(-0.01 / kLength);
  const Eigen::MatrixXd along = AutoregressiveSeries(3 * kFrames, kPoints, a, 3);
  Eigen::MatrixXd vectors(3 * kPoints, kFrames);
  for (int f = 0; f < kFrames; ++f)
    for (int m = 0; m < kPoints; ++m)
      vectors.col(f).segment<3>(3 * m) = along.col(m).segment<3>(3 * f);
  const SpaceWhiteness whiteness = WhitenessInSpace(vectors, places);
  EXPECT_EQ(whiteness.pairs.size(), 15u);
  EXPECT_NEAR(whiteness.correlation_length, kLength, 0.003);  // 6000 samples: 1 % of ρ each
  EXPECT_LE(whiteness.p_value, 0.005);  // the smallest possible with 199 shifts
  // Identical residuals at all points.
  Eigen::MatrixXd alike(3 * kPoints, kFrames);
  const Eigen::MatrixXd common = WhiteSeries(3, kFrames, 5);
  for (int m = 0; m < kPoints; ++m) alike.middleRows<3>(3 * m) = common;
  EXPECT_TRUE(std::isinf(WhitenessInSpace(alike, places).correlation_length));
  EXPECT_NEAR(WhitenessInSpace(alike, places).mean_correlation, 1, 1e-9);
}

TEST(ResidualStatistics, WhiteNoiseIsEstimatedUnderMotion) {
  Eigen::MatrixXd positions = WhiteSeries(9, 1000, 2, 1e-5);
  const Eigen::VectorXd times = Times(1000, 0.01);
  for (int f = 0; f < 1000; ++f) positions.col(f).array() += 0.01 * std::sin(times[f]);
  // The second difference of the motion is at most 1e-6; the error of the medians is 2 %.
  EXPECT_NEAR(WhiteNoise(positions), 1e-5, 0.05e-5);
}

TEST(ResidualStatistics, StaticSpansAreFoundWithTheirNoiseAndDrift) {
  constexpr double kNoise = 1e-5, kDrift = 1e-5;
  const Eigen::VectorXd times = Times(300, 0.01);
  Eigen::MatrixXd positions = WhiteSeries(12, 300, 4, kNoise);
  for (int f = 0; f < 300; ++f) {
    const double moved = f < 100 ? 0 : f < 200 ? 1e-4 * (f - 99) : 1e-2;
    for (int m = 0; m < 4; ++m) {
      positions(3 * m, f) += moved;
      if (f >= 200) positions(3 * m + 2, f) += kDrift * (times[f] - times[200]);
    }
  }
  const std::vector<StaticSpan> rests =
      StaticSpans(times, positions, 2 * std::sqrt(6.0) * kNoise, 10);
  ASSERT_EQ(rests.size(), 2u);
  EXPECT_EQ(rests[0].first, 0);
  EXPECT_EQ(rests[0].last, 99);
  EXPECT_NEAR(rests[1].first, 199, 1);
  EXPECT_EQ(rests[1].last, 299);
  for (const StaticSpan& rest : rests) EXPECT_NEAR(rest.deviation, kNoise, 0.1 * kNoise);
  // A slope over one second with 100 frames has the standard deviation σ √12 / (√100 s) = 3.5e-6
  // per coordinate, and noise alone gives a drift of √3 times as much.
  EXPECT_NEAR(rests[1].drift, std::hypot(kDrift, 6e-6), 4e-6);
  // As above, but the margin at the border with the motion shortens the second rest.
  EXPECT_NEAR(rests[1].noise_drift, std::sqrt(3.0) * 3.5e-6 * std::pow(0.84, -1.5), 1e-6);
  EXPECT_LT(rests[0].drift, 2 * rests[0].noise_drift);
}

TEST(ResidualStatistics, SpeedAndDisplacementOfAUniformMotion) {
  const Eigen::VectorXd times = Times(20, 0.1);
  Eigen::MatrixXd positions(3, 20);
  for (int f = 0; f < 20; ++f) positions.col(f) = Eigen::Vector3d(3, 0, 4) * times[f];
  positions.col(5).setConstant(kNan);
  const Eigen::MatrixXd speeds = Speeds(times, positions);
  const Eigen::MatrixXd displacements = Displacements(positions);
  EXPECT_NEAR(speeds(0, 0), 5, 1e-12);
  EXPECT_NEAR(speeds(0, 19), 5, 1e-12);
  EXPECT_TRUE(std::isnan(speeds(0, 4)));
  EXPECT_NEAR(displacements(0, 19), 5 * times[19], 1e-12);
  EXPECT_TRUE(std::isnan(displacements(0, 5)));
}

TEST(ResidualStatistics, AnErrorProportionalToSpeedShowsInBinsAndRanks) {
  const Eigen::MatrixXd speed = Eigen::RowVectorXd::LinSpaced(100, 0, 1);
  const Eigen::MatrixXd error = 2 * speed.array().square();
  const std::vector<ResidualBin> bins = BinnedResiduals(speed, error, 5);
  ASSERT_EQ(bins.size(), 5u);
  for (const ResidualBin& bin : bins) EXPECT_EQ(bin.points, 20);
  for (size_t k = 1; k < bins.size(); ++k) EXPECT_GT(bins[k].rms, bins[k - 1].rms);
  EXPECT_NEAR(RankCorrelation(speed, error), 1, 1e-12);
  EXPECT_NEAR(RankCorrelation(speed, -error), -1, 1e-12);
  EXPECT_TRUE(std::isnan(RankCorrelation(speed, 0 * error)));
  // With only two values, of which one makes up three quarters, equal values stay in one bin.
  Eigen::MatrixXd two = Eigen::MatrixXd::Ones(1, 100);
  two.rightCols(25).setConstant(2);
  const std::vector<ResidualBin> of_two = BinnedResiduals(two, error, 5);
  ASSERT_EQ(of_two.size(), 2u);
  EXPECT_EQ(of_two[0].points, 75);
}

TEST(ResidualStatistics, ASpanOfErrorAndItsDirectionAreFound) {
  Eigen::MatrixXd error = WhiteSeries(9, 100, 6, 1e-5);
  for (int f = 40; f < 60; ++f) error.row(5).segment(f, 1).array() -= 1e-3;  // point 1 moves down
  error.col(50).setConstant(kNan);
  error.col(80).array() += 1e-2;  // a single bad frame is shorter than the span
  const Eigen::VectorXd of_frames = RmsOfFrames(PointLengths(error));
  const FrameSpan span = LongestSpanAbove(of_frames, 2e-4);
  EXPECT_EQ(span.first, 40);
  EXPECT_EQ(span.last, 59);
  EXPECT_EQ(span.above, 19);  // frame 50 was not seen
  EXPECT_EQ(LongestSpanAbove(of_frames, 1).first, -1);
  EXPECT_EQ(LongestSpanAbove(of_frames, 2e-4, 19).last, 59);
  EXPECT_EQ(LongestSpanAbove(of_frames, 2e-4, 20).last, 80);
  const MeanVector of_point = MeanOver(error.middleRows<3>(3), span.first, span.last);
  EXPECT_NEAR(of_point.mean[2], -1e-3, 2e-5);
  EXPECT_GT(of_point.agreement, 0.99);
  // For 100 random vectors |Σ e| / Σ |e| is about 0.1.
  EXPECT_LT(MeanOver(WhiteSeries(3, 100, 8), 0, 99).agreement, 0.3);
}

TEST(ResidualStatistics, RepeatsAreAlignedAndTheirDistanceIsTheNoise) {
  constexpr double kNoise = 1e-5, kDelay = 0.237;
  const auto motion = [](double t) { return 0.01 * std::exp(-t) * std::sin(9 * t); };
  const Eigen::VectorXd first_times = Times(300, 0.01);
  const Eigen::VectorXd second_times = Times(320, 0.01);
  Eigen::MatrixXd first = WhiteSeries(6, 300, 10, kNoise);
  Eigen::MatrixXd second = WhiteSeries(6, 320, 11, kNoise);
  for (int f = 0; f < 300; ++f) first.col(f).array() += motion(first_times[f]);
  for (int f = 0; f < 320; ++f)
    second.col(f).array() += 0.002 + motion(second_times[f] - kDelay);  // attached elsewhere
  const Repeatability repeats = CompareRepeats(first_times, first, second_times, second, 0.2, 0.1);
  EXPECT_NEAR(repeats.delay, kDelay, 1e-4);
  // √6 σ, plus the interpolation error of the motion, h²/8 times the acceleration 0.8, i.e. at most
  // 1e-5. 1800 differences determine the rms within 2 %.
  EXPECT_GT(repeats.distance, 0.94 * std::sqrt(6.0) * kNoise);
  EXPECT_LT(repeats.distance, 1.2 * std::sqrt(6.0) * kNoise);
  EXPECT_EQ(CompareRepeats(first_times, first, second_times.array() + 100, second, 0, 0.1).frames,
            0);
}

// Midway between two frames, interpolation halves the variance of the second recording's noise, and
// where nothing moves, the delay of the smallest distance is sought in the noise alone.
TEST(ResidualStatistics, InterpolationDoesNotMakeRepeatsMoreAlike) {
  const Eigen::VectorXd times = Times(400, 0.01);
  double sum = 0;
  constexpr int kSeeds = 5;
  for (unsigned seed = 0; seed < kSeeds; ++seed)
    sum += CompareRepeats(times, WhiteSeries(6, 400, 100 + seed), times,
                          WhiteSeries(6, 400, 200 + seed), 0.005, 0.004)
               .distance;
  // √6 for noise of deviation 1. The 12000 differences determine it within 1 %, and the search
  // finds the smallest of some independent values. Without the correction it would be 0.87 of it.
  EXPECT_NEAR(sum / kSeeds / std::sqrt(6.0), 1, 0.04);
}

// Few frames are common to both at the nominal delay, which leaves the distance there unknown.
TEST(ResidualStatistics, RepeatsAreAlignedFromADelayWithHardlyAnyOverlap) {
  const auto motion = [](double t) { return 0.01 * std::sin(9 * t); };
  const Eigen::VectorXd times = Times(100, 0.01);
  Eigen::MatrixXd first = WhiteSeries(6, 100, 12, 1e-5), second = WhiteSeries(6, 100, 13, 1e-5);
  for (int f = 0; f < 100; ++f) {
    first.col(f).array() += motion(times[f]);
    second.col(f).array() += motion(times[f] - 0.5);
  }
  // At a delay of 0.95 s, the last frames of the second recording meet the first five of the first.
  const Repeatability repeats = CompareRepeats(times, first, times, second, 0.95, 0.6);
  EXPECT_NEAR(repeats.delay, 0.5, 1e-3);
  EXPECT_LT(repeats.distance, 1e-4);
}

}  // namespace
}  // namespace lacuna
