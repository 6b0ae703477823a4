#include "analysis/series_noise.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace lacuna {
namespace {

SeriesLayout Irregular() {
  SeriesLayout layout{3, {0, 0.1, 0.15, 0.4, 0.5, 0.55}, std::vector<double>(18, 1), {}};
  layout.count[3] = layout.count[7] = layout.count[17] = 0;
  layout.count[0] = 4;  // a mean of four measurements
  return layout;
}

TEST(SeriesNoise, WhitensItsCovariance) {
  // W Σ Wᵀ = 1 for the observed rows of one series.
  const SeriesLayout layout = Irregular();
  const SeriesNoise noise{0.3, 0.2, 0.7};
  const Eigen::MatrixXd W =
      Whitened(Eigen::MatrixXd::Identity(layout.Rows(), layout.Rows()), layout, noise);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(layout.Rows(), layout.Rows());
  Eigen::MatrixXd expected = covariance;
  for (Eigen::Index i = 0; i < layout.Rows(); ++i) {
    for (Eigen::Index j = 0; j < layout.Rows(); ++j) {
      if (i % 3 != j % 3 || !layout.count[i] || !layout.count[j]) continue;
      const double apart = std::abs(layout.times[i / 3] - layout.times[j / 3]);
      covariance(i, j) =
          0.09 * std::exp(-apart / 0.2) / std::sqrt(layout.count[i] * layout.count[j]) + 0.49;
      expected(i, j) = i == j;
    }
  }
  EXPECT_LT((W * covariance * W.transpose() - expected).norm(), 1e-12);  // rounding
}

// The offset of a marker is rotated and stretched with the object.
TEST(SeriesNoise, WhitensOffsetsThatMoveWithTheObject) {
  SeriesLayout layout{6, {0, 0.1, 0.15, 0.4}, std::vector<double>(24, 1), {}};
  for (const int hidden : {9, 10, 11}) layout.count[hidden] = 0;  // the second point in frame 1
  std::srand(1);
  for (int k = 0; k < 8; ++k)
    layout.deformation.push_back(Eigen::Matrix3d::Identity() + 0.8 * Eigen::Matrix3d::Random());
  const SeriesNoise noise{0.3, 0.2, 0.7};
  const Eigen::MatrixXd W = Whitened(Eigen::MatrixXd::Identity(24, 24), layout, noise);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(24, 24), expected = covariance;
  for (Eigen::Index i = 0; i < 24; ++i) {
    for (Eigen::Index j = 0; j < 24; ++j) {
      if (!layout.count[i] || !layout.count[j]) continue;
      expected(i, j) = i == j;
      if (i / 3 % 2 != j / 3 % 2) continue;  // different points
      covariance(i, j) =
          0.49 * layout.deformation[i / 3].row(i % 3).dot(layout.deformation[j / 3].row(j % 3));
      const double apart = std::abs(layout.times[i / 6] - layout.times[j / 6]);
      if (i % 3 == j % 3) covariance(i, j) += 0.09 * std::exp(-apart / 0.2);
    }
  }
  EXPECT_LT((W * covariance * W.transpose() - expected).norm(), 1e-12);  // rounding
  // In a body that does not deform, the offset is constant.
  layout.deformation.assign(8, Eigen::Matrix3d::Identity());
  SeriesLayout still = layout;
  still.deformation.clear();
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(24, 3);
  EXPECT_LT((Whitened(rows, layout, noise) - Whitened(rows, still, noise)).norm(), 1e-12);
}

// A marker that two recordings show, in another order, has the same offset in both.
TEST(SeriesNoise, WhitensOffsetsThatRecordingsShare) {
  std::srand(2);
  const auto deformed = [](size_t frames) {
    std::vector<Eigen::Matrix3d> deformation;
    for (size_t k = 0; k < 2 * frames; ++k)
      deformation.push_back(Eigen::Matrix3d::Identity() + 0.8 * Eigen::Matrix3d::Random());
    return deformation;
  };
  SeriesLayout first{6, {0, 0.1, 0.4}, std::vector<double>(18, 1), deformed(3), {0, 1}};
  first.count[7] = first.count[6] = first.count[8] = 0;  // the first point in frame 1
  const SeriesLayout second{6, {0, 0.2}, std::vector<double>(12, 1), deformed(2), {1, 5}};
  const SeriesLayout force{1, {0, 0.1, 0.4}, {1, 1, 1}, {}};
  const SeriesNoise noise{0.3, 0.2, 0.7}, of_force{2, 0, 3};
  // The rows of the second recording come first, then one that belongs to neither.
  const std::vector<NoisyRecording> all = {
      {13, &first, noise}, {0, &second, noise}, {31, &force, of_force}};
  const Eigen::MatrixXd W = Whitened(Eigen::MatrixXd::Identity(34, 34), all);

  struct Row {
    int recording, point, component;
    double time;
    Eigen::RowVector3d shows;
  };
  std::map<int, Row> rows;  // those that were observed
  for (int k = 0; k < 30; ++k) {
    const bool is_first = k < 18;
    const SeriesLayout& layout = is_first ? first : second;
    const int at = is_first ? k : k - 18;
    if (layout.count[at] == 0) continue;
    rows[is_first ? 13 + at : at] = {is_first, layout.offset_ids[at / 3 % 2], at % 3,
                                     layout.times[at / 6], layout.deformation[at / 3].row(at % 3)};
  }
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(34, 34), expected = covariance;
  for (const auto& [i, a] : rows) {
    expected(i, i) = 1;
    for (const auto& [j, b] : rows) {
      if (a.point != b.point) continue;
      covariance(i, j) = 0.49 * a.shows.dot(b.shows);
      if (a.recording == b.recording && a.component == b.component)
        covariance(i, j) += 0.09 * std::exp(-std::abs(a.time - b.time) / 0.2);
    }
  }
  covariance.bottomRightCorner<3, 3>().setConstant(9);
  covariance.bottomRightCorner<3, 3>().diagonal().array() += 4;
  expected.bottomRightCorner<3, 3>().setIdentity();
  EXPECT_LT((W * covariance * W.transpose() - expected).norm(), 1e-12);  // rounding

  // A recording whose offsets are its own is whitened as if it were alone.
  SeriesLayout apart = second;
  apart.offset_ids = {};
  const Eigen::MatrixXd two = Eigen::MatrixXd::Random(30, 2);
  const Eigen::MatrixXd white = Whitened(two, {{0, &first, noise}, {18, &apart, noise}});
  EXPECT_EQ(white.bottomRows(12), Whitened(Eigen::MatrixXd(two.bottomRows(12)), apart, noise));
}

TEST(SeriesNoise, TreatsExcludedFramesAsAbsent) {
  const SeriesLayout layout = Irregular();
  const std::vector<char> chosen = {1, 1, 1, 0, 1, 0};
  SeriesLayout without = layout;
  for (Eigen::Index row = 0; row < layout.Rows(); ++row)
    if (!chosen[row / 3]) without.count[row] = 0;
  const Eigen::MatrixXd rows = Eigen::MatrixXd::Random(layout.Rows(), 2);
  const SeriesNoise noise{0.3, 0.2, 0.7};
  EXPECT_EQ(Whitened(rows, layout, noise, chosen), Whitened(rows, without, noise));
}

TEST(SeriesNoise, EstimatesTheCorrelationTime) {
  SeriesLayout layout{40, {}, {}, {}};
  for (int frame = 0; frame < 60; ++frame) layout.times.push_back(0.01 * frame);
  layout.count.assign(static_cast<size_t>(layout.Rows()), 1);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (const double memory : {0.0, 0.5}) {
    Eigen::VectorXd rows(layout.Rows());
    for (Eigen::Index row = 0; row < rows.size(); ++row)
      rows[row] = row < 40
                      ? normal(random)
                      : memory * rows[row - 40] + std::sqrt(1 - memory * memory) * normal(random);
    const SeriesStatistics statistics = Statistics(rows, layout);
    EXPECT_NEAR(statistics.spacing, 0.01, 1e-12);  // rounding of the times
    // For 2400 rows: 0.02 by chance, and 1/60 by the subtracted means, times (1 + ρ)/(1 − ρ).
    EXPECT_NEAR(statistics.lag_one, memory, 0.08);
    // 1 + 2 Σ (1 − k/9) ρᵏ.
    EXPECT_NEAR(statistics.long_run, memory == 0 ? 1 : 2.55, memory == 0 ? 0.15 : 0.5);
    const SeriesNoise noise{1, CorrelationTime(statistics), 0};
    EXPECT_NEAR(Statistics(Whitened(rows, layout, noise), layout).long_run, 1, 0.15);
  }
}

TEST(SeriesNoise, DeviationOfAShortRecordAccountsForCorrelation) {
  // 13 frames of noise with a lag-one correlation of 0.45 about lines of any slope. The plain
  // standard deviation about a line would be 11 % too small.
  constexpr double kDeviation = 2e-4, kMemory = 0.45;
  constexpr int kFrames = 13, kSeries = 2000;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(kFrames, 3, 3.12);
  Eigen::MatrixXd rows(kSeries, kFrames);
  for (int s = 0; s < kSeries; ++s) {
    double value = normal(random);
    for (int f = 0; f < kFrames; ++f) {
      if (f > 0) value = kMemory * value + std::sqrt(1 - kMemory * kMemory) * normal(random);
      rows(s, f) = 0.3 * s + 1e-3 * s * times[f] + kDeviation * value;
    }
  }
  // The random error of 2000 series is 1 %, and correlations are tried in steps of 0.05.
  EXPECT_NEAR(DeviationAboutTrend(times, rows), kDeviation, 0.02 * kDeviation);
  EXPECT_EQ(DeviationAboutTrend(times, Eigen::MatrixXd::Zero(2, kFrames)), 0);
}

// Slower noise than the largest correlation that is tried, 0.9, gives 0.54 of the deviation with
// that one and 0.44 with the next smaller one; the random error is below 1 %.
TEST(SeriesNoise, DeviationTriesTheLargestCorrelation) {
  constexpr double kMemory = 0.97;
  constexpr int kFrames = 13, kSeries = 2000;
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  Eigen::MatrixXd rows(kSeries, kFrames);
  for (int s = 0; s < kSeries; ++s) {
    rows(s, 0) = normal(random);
    for (int f = 1; f < kFrames; ++f)
      rows(s, f) = kMemory * rows(s, f - 1) + std::sqrt(1 - kMemory * kMemory) * normal(random);
  }
  EXPECT_NEAR(DeviationAboutTrend(Eigen::VectorXd::LinSpaced(kFrames, 0, 0.12), rows), 0.54, 0.03);
}

}  // namespace
}  // namespace lacuna
