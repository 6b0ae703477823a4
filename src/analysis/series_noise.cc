#include "analysis/series_noise.h"

#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
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

// The series of one recording that have an offset in common.
struct OffsetMember {
  const NoisyRecording* recording;
  int first_series;

  Eigen::Index FrameCount() const {
    return static_cast<Eigen::Index>(recording->layout->times.size());
  }
};

// The series that share each offset, in the order of the rows.
std::vector<std::vector<OffsetMember>> MembersOfOffsets(
    const std::vector<NoisyRecording>& recordings) {
  std::vector<std::vector<OffsetMember>> offsets;
  std::map<int, size_t> known;  // from the number of an offset to its place in `offsets`
  for (const NoisyRecording& recording : recordings) {
    const SeriesLayout& layout = *recording.layout;
    if (layout.times.empty()) continue;
    const int width = layout.SeriesPerOffset();
    CHECK_EQ(layout.series % width, 0);
    CHECK(layout.offset_ids.empty() || std::ssize(layout.offset_ids) == layout.series / width);
    for (int first = 0; first < layout.series; first += width) {
      size_t at = offsets.size();
      if (!layout.offset_ids.empty())
        at = known.try_emplace(layout.offset_ids[static_cast<size_t>(first / width)], at)
                 .first->second;
      if (at == offsets.size()) offsets.emplace_back();
      offsets[at].push_back({&recording, first});
    }
  }
  return offsets;
}

// Whitens the series that share one offset, of `rows` into `white`.
void WhitenTogether(const std::vector<OffsetMember>& members, const Eigen::MatrixXd& rows,
                    Eigen::MatrixXd* white) {
  const int width = members.front().recording->layout->SeriesPerOffset();
  Eigen::Index height = 0;
  for (const OffsetMember& member : members) height += width * member.FrameCount();
  Eigen::MatrixXd block(height, rows.cols());  // recordings outermost, then coordinates
  Eigen::MatrixXd common(height, width);       // response to an offset of one deviation
  const auto rows_of = [](const OffsetMember& member, int c) {
    return Eigen::seqN(member.recording->first_row + member.first_series + c, member.FrameCount(),
                       member.recording->layout->series);
  };
  Eigen::Index next = 0;
  for (const OffsetMember& member : members) {
    const SeriesLayout& layout = *member.recording->layout;
    const SeriesNoise& noise = member.recording->noise;
    const std::vector<char>* frames = member.recording->frames;
    CHECK_EQ(layout.SeriesPerOffset(), width);
    CHECK_EQ(noise.offset_deviation, members.front().recording->noise.offset_deviation);
    const Eigen::Index frame_count = member.FrameCount();
    for (int c = 0; c < width; ++c, next += frame_count) {
      std::vector<double> count(layout.times.size());
      Eigen::MatrixXd own(frame_count, width);
      for (Eigen::Index f = 0; f < frame_count; ++f) {
        const bool is_chosen = frames == nullptr || frames->empty() || (*frames)[f];
        count[f] = is_chosen ? layout.count[f * layout.series + member.first_series + c] : 0;
        if (width == 1)
          own(f, 0) = 1;
        else
          own.row(f) = layout.deformation[(f * layout.series + member.first_series) / width].row(c);
      }
      own *= noise.offset_deviation / noise.deviation;
      block.middleRows(next, frame_count) =
          Uncorrelated(rows(rows_of(member, c), Eigen::all) / noise.deviation, layout.times, count,
                       noise.correlation_time);
      common.middleRows(next, frame_count) =
          Uncorrelated(own, layout.times, count, noise.correlation_time);
    }
  }
  // (I + U Uᵀ)^(−1/2) reduces the components along the left singular vectors of U.
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(common.transpose() * common);
  const Eigen::MatrixXd along = common * eigen.eigenvectors();
  for (int k = 0; k < width; ++k) {
    const double square = eigen.eigenvalues()[k];
    if (!(square > 0)) continue;  // no offset, or not observed
    const double share = (1 - 1 / std::sqrt(1 + square)) / square;
    block -= along.col(k) * (share * (along.col(k).transpose() * block));
  }
  next = 0;
  for (const OffsetMember& member : members)
    for (int c = 0; c < width; ++c, next += member.FrameCount())
      (*white)(rows_of(member, c), Eigen::all) = block.middleRows(next, member.FrameCount());
}

}  // namespace

Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows, const SeriesLayout& layout,
                         const SeriesNoise& noise, const std::vector<char>& frames) {
  CHECK_EQ(rows.rows(), layout.Rows());
  return Whitened(rows, {{0, &layout, noise, &frames}});
}

Eigen::MatrixXd Whitened(const Eigen::MatrixXd& rows,
                         const std::vector<NoisyRecording>& recordings) {
  for (const NoisyRecording& recording : recordings) {
    CHECK_LE(recording.first_row + recording.layout->Rows(), rows.rows());
    CHECK_GT(recording.noise.deviation, 0);
  }
  Eigen::MatrixXd white = Eigen::MatrixXd::Zero(rows.rows(), rows.cols());
  if (rows.cols() == 0) return white;
  for (const std::vector<OffsetMember>& members : MembersOfOffsets(recordings))
    WhitenTogether(members, rows, &white);
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
