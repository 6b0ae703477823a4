#include "analysis/series_noise.h"

#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/median.h"

namespace lacuna {
namespace {

constexpr int kLags = 8;  // number of lags in the long-run variance
// Series with fewer frames do not allow an estimate of the correlation.
constexpr size_t kFewestFrames = 8;
// Noise with a larger lag-one correlation cannot be distinguished from motion.
constexpr double kLargestCorrelation = 0.9;
constexpr int kCorrelationSteps = 18;  // from 0 up to it, both of which are tried
constexpr double kCorrelationStep = kLargestCorrelation / kCorrelationSteps;

// Applies R^(−1/2) to each column of `values` (frames × columns) of one series. Frames in which the
// series was not observed become 0.
Eigen::MatrixXd Uncorrelated(const Eigen::MatrixXd& values, const std::vector<double>& times,
                             const std::vector<double>& count, double correlation_time) {
  Eigen::MatrixXd white = Eigen::MatrixXd::Zero(values.rows(), values.cols());
  Eigen::Index last = -1;
  for (Eigen::Index f = 0; f < values.rows(); ++f) {
    if (count[f] == 0) continue;
    double memory = 0;
    if (last >= 0 && correlation_time > 0)
      memory = std::exp(-(times[f] - times[last]) / correlation_time);
    const double scale = 1 / std::sqrt(1 - memory * memory);
    white.row(f) = scale * std::sqrt(count[f]) * values.row(f);
    if (memory > 0) white.row(f) -= scale * memory * std::sqrt(count[last]) * values.row(last);
    last = f;
  }
  return white;
}

}  // namespace

Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const SeriesLayout& layout,
                         const SeriesNoise& noise, const std::vector<char>& frames) {
  CHECK_EQ(rows.rows(), layout.Rows());
  CHECK_GT(noise.deviation, 0);
  const Eigen::Index frame_count = static_cast<Eigen::Index>(layout.times.size());
  const double ratio = noise.offset_deviation / noise.deviation;
  // Number of series with a joint offset: three coordinates that deform together, or one.
  const int width = layout.deformation.empty() ? 1 : 3;
  CHECK_EQ(layout.series % width, 0);
  Eigen::MatrixXd white(rows.rows(), rows.cols());
  Eigen::MatrixXd block(width * frame_count, rows.cols());  // coordinates outermost
  Eigen::MatrixXd common(width * frame_count, width);       // response to a unit offset
  for (int first = 0; first < layout.series; first += width) {
    for (int c = 0; c < width; ++c) {
      const int s = first + c;
      std::vector<double> count(layout.times.size());
      Eigen::MatrixXd own(frame_count, width);
      for (Eigen::Index f = 0; f < frame_count; ++f) {
        const bool is_chosen = frames.empty() || frames[f];
        count[f] = is_chosen ? layout.count[f * layout.series + s] : 0;
        if (width == 1)
          own(f, 0) = 1;
        else
          own.row(f) = layout.deformation[(f * layout.series + first) / width].row(c);
      }
      const auto series = rows(Eigen::seqN(s, frame_count, layout.series), Eigen::all);
      block.middleRows(c * frame_count, frame_count) =
          Uncorrelated(series / noise.deviation, layout.times, count, noise.correlation_time);
      common.middleRows(c * frame_count, frame_count) =
          Uncorrelated(own, layout.times, count, noise.correlation_time);
    }
    if (ratio > 0) {
      // (I + ratio² U Uᵀ)^(−1/2) reduces the components along the left singular vectors of U.
      const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(common.transpose() * common);
      const Eigen::MatrixXd along = common * eigen.eigenvectors();
      for (int k = 0; k < width; ++k) {
        const double square = eigen.eigenvalues()[k];
        if (!(square > 0)) continue;  // not observed
        const double share = (1 - 1 / std::sqrt(1 + square * ratio * ratio)) / square;
        block -= along.col(k) * (share * (along.col(k).transpose() * block));
      }
    }
    for (int c = 0; c < width; ++c)
      white(Eigen::seqN(first + c, frame_count, layout.series), Eigen::all) =
          block.middleRows(c * frame_count, frame_count);
  }
  return white;
}

double DeviationAboutTrend(const Eigen::VectorXd& times, const Eigen::MatrixXd& rows) {
  const Eigen::Index count = times.size();
  CHECK_EQ(rows.cols(), count);
  CHECK_GE(count, 3);
  const double spacing = (times[count - 1] - times[0]) / static_cast<double>(count - 1);
  // Columns: a constant, the time, the series.
  Eigen::MatrixXd seen(count, 2 + rows.rows());
  seen << Eigen::VectorXd::Ones(count), times.array() - times[0],
      (rows.colwise() - rows.col(0)).transpose();
  const double series = static_cast<double>(rows.rows());
  const double freedom = series * static_cast<double>(count - 2);
  double most = -std::numeric_limits<double>::infinity(), deviation = 0;
  for (int step = 0; step <= kCorrelationSteps; ++step) {
    const double correlation = step * kCorrelationStep;
    Eigen::MatrixXd white = seen;
    double log_determinant = 0;
    for (Eigen::Index f = 1; f < count; ++f) {
      const double memory =
          correlation > 0 ? std::pow(correlation, (times[f] - times[f - 1]) / spacing) : 0;
      white.row(f) = (seen.row(f) - memory * seen.row(f - 1)) / std::sqrt(1 - memory * memory);
      log_determinant += std::log(1 - memory * memory);
    }
    const auto line = white.leftCols<2>();
    const auto y = white.rightCols(rows.rows());
    const Eigen::Matrix2d normal = line.transpose() * line;
    const Eigen::MatrixXd toward = line.transpose() * y;
    const double squares =
        y.squaredNorm() - (toward.array() * (normal.inverse() * toward).array()).sum();
    if (!(squares > 0)) return 0;
    const double likelihood = -0.5 * (freedom * std::log(squares / freedom) +
                                      series * (log_determinant + std::log(normal.determinant())));
    if (likelihood <= most) continue;
    most = likelihood;
    deviation = std::sqrt(squares / freedom);
  }
  return deviation;
}

SeriesStatistics Statistics(const Eigen::VectorXd& residual, const SeriesLayout& layout) {
  SeriesStatistics statistics;
  const Eigen::Index frames = static_cast<Eigen::Index>(layout.times.size());
  if (layout.times.size() < kFewestFrames) return statistics;
  std::vector<double> spacings;
  for (size_t f = 1; f < layout.times.size(); ++f)
    spacings.push_back(layout.times[f] - layout.times[f - 1]);
  statistics.spacing = Median(std::move(spacings));

  std::vector<double> product(kLags + 1, 0.0);
  double pairs_at_zero = 0;
  std::vector<double> pairs(kLags + 1, 0.0);
  for (int s = 0; s < layout.series; ++s) {
    double mean = 0;
    int seen = 0;
    const auto observed = [&](Eigen::Index f) { return layout.count[f * layout.series + s] > 0; };
    for (Eigen::Index f = 0; f < frames; ++f) {
      if (!observed(f)) continue;
      mean += residual[f * layout.series + s];
      ++seen;
    }
    if (seen < static_cast<int>(kFewestFrames)) continue;
    mean /= seen;
    for (int lag = 0; lag <= kLags; ++lag) {
      for (Eigen::Index f = 0; f + lag < frames; ++f) {
        if (!observed(f) || !observed(f + lag)) continue;
        product[lag] += (residual[f * layout.series + s] - mean) *
                        (residual[(f + lag) * layout.series + s] - mean);
        pairs[lag] += 1;
      }
    }
  }
  pairs_at_zero = pairs[0];
  if (!(product[0] > 0)) return statistics;
  double sum = 1;
  for (int lag = 1; lag <= kLags; ++lag) {
    if (pairs[lag] == 0) continue;
    const double correlation = product[lag] / pairs[lag] / (product[0] / pairs_at_zero);
    if (lag == 1) statistics.lag_one = correlation;
    sum += 2 * (1 - lag / (kLags + 1.0)) * correlation;
  }
  statistics.long_run = std::max(1.0, sum);
  return statistics;
}

double CorrelationTime(const SeriesStatistics& statistics) {
  const double correlation = std::min(statistics.lag_one, kLargestCorrelation);
  if (!(correlation > 0)) return 0;
  return -statistics.spacing / std::log(correlation);
}

}  // namespace lacuna
