#include "analysis/residual_statistics.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "analysis/series_noise.h"
#include "core/median.h"

namespace lacuna {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

double RmsBetween(const Eigen::MatrixXd& positions, Eigen::Index a, Eigen::Index b) {
  return Rms(PointLengths(positions.col(a) - positions.col(b)));
}

// The pairs of entries that are both not NaN.
std::vector<std::pair<double, double>> SeenPairs(const Eigen::MatrixXd& a,
                                                 const Eigen::MatrixXd& b) {
  CHECK_EQ(a.rows(), b.rows());
  CHECK_EQ(a.cols(), b.cols());
  std::vector<std::pair<double, double>> pairs;
  for (Eigen::Index k = 0; k < a.size(); ++k)
    if (!std::isnan(a.data()[k]) && !std::isnan(b.data()[k]))
      pairs.emplace_back(a.data()[k], b.data()[k]);
  return pairs;
}

Eigen::VectorXd Ranks(const std::vector<double>& values) {
  std::vector<size_t> order(values.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](size_t i, size_t j) { return values[i] < values[j]; });
  Eigen::VectorXd ranks(static_cast<Eigen::Index>(values.size()));
  for (size_t begin = 0; begin < order.size();) {
    size_t end = begin;
    while (end < order.size() && values[order[end]] == values[order[begin]]) ++end;
    for (size_t k = begin; k < end; ++k)
      ranks[static_cast<Eigen::Index>(order[k])] = 0.5 * static_cast<double>(begin + end - 1);
    begin = end;
  }
  return ranks;
}

// Interpolates the rows linearly at `time`, which multiplies the variance of white noise by
// `noise_gain`; returns false outside the range of the frames.
bool At(const Eigen::VectorXd& times, const Eigen::MatrixXd& rows, double time,
        Eigen::VectorXd* value, double* noise_gain) {
  const Eigen::Index count = times.size();
  if (count < 2 || time < times[0] || time > times[count - 1]) return false;
  const double* after = std::upper_bound(times.data(), times.data() + count - 1, time);
  const Eigen::Index next = std::max<Eigen::Index>(1, after - times.data());
  const double share = (time - times[next - 1]) / (times[next] - times[next - 1]);
  *value = (1 - share) * rows.col(next - 1) + share * rows.col(next);
  *noise_gain = (1 - share) * (1 - share) + share * share;
  return true;
}

}  // namespace

Eigen::MatrixXd Centred(Eigen::MatrixXd series) {
  for (Eigen::Index row = 0; row < series.rows(); ++row) {
    double sum = 0;
    int count = 0;
    for (const double value : series.row(row)) {
      if (std::isnan(value)) continue;
      sum += value;
      ++count;
    }
    if (count > 0) series.row(row).array() -= sum / count;
  }
  return series;
}

Eigen::MatrixXd PointLengths(const Eigen::MatrixXd& vectors) {
  CHECK_EQ(vectors.rows() % 3, 0);
  Eigen::MatrixXd lengths(vectors.rows() / 3, vectors.cols());
  for (Eigen::Index f = 0; f < lengths.cols(); ++f)
    for (Eigen::Index m = 0; m < lengths.rows(); ++m)
      lengths(m, f) = vectors.col(f).segment<3>(3 * m).norm();
  return lengths;
}

double Rms(const Eigen::MatrixXd& lengths) {
  double squares = 0;
  int count = 0;
  for (Eigen::Index k = 0; k < lengths.size(); ++k) {
    const double length = lengths.data()[k];
    if (std::isnan(length)) continue;
    squares += length * length;
    ++count;
  }
  return count > 0 ? std::sqrt(squares / count) : kUnknown;
}

Eigen::VectorXd RmsOfPoints(const Eigen::MatrixXd& lengths) {
  Eigen::VectorXd rms(lengths.rows());
  for (Eigen::Index m = 0; m < rms.size(); ++m) rms[m] = Rms(lengths.row(m));
  return rms;
}

Eigen::VectorXd RmsOfFrames(const Eigen::MatrixXd& lengths) {
  Eigen::VectorXd rms(lengths.cols());
  for (Eigen::Index f = 0; f < rms.size(); ++f) rms[f] = Rms(lengths.col(f));
  return rms;
}

double WhiteNoise(const Eigen::MatrixXd& positions) {
  const auto from_differences = [&](const Eigen::VectorXd& weight) {
    std::vector<double> of_rows;
    for (Eigen::Index row = 0; row < positions.rows(); ++row) {
      std::vector<double> differences;
      for (Eigen::Index f = 0; f + weight.size() <= positions.cols(); ++f) {
        const double value = positions.row(row).segment(f, weight.size()) * weight;
        if (!std::isnan(value)) differences.push_back(std::abs(value));
      }
      if (!differences.empty())
        of_rows.push_back(Median(std::move(differences)) / (0.6745 * weight.norm()));
    }
    return Median(std::move(of_rows));
  };
  const double second = from_differences(Eigen::Vector3d(1, -2, 1));
  const double fourth = from_differences((Eigen::VectorXd(5) << 1, -4, 6, -4, 1).finished());
  return fourth < second ? fourth : second;
}

StaticSpan MeasureSpan(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions, int first,
                       int last) {
  StaticSpan span{first, last, first, last};
  double squares = 0, slopes = 0, slope_variances = 0;  // the last for noise of deviation 1
  int freedom = 0, rows = 0;
  for (Eigen::Index row = 0; row < positions.rows(); ++row) {
    double t = 0, x = 0;
    int count = 0;
    for (int f = first; f <= last; ++f) {
      if (std::isnan(positions(row, f))) continue;
      t += times[f];
      x += positions(row, f);
      ++count;
    }
    if (count < 3) continue;
    t /= count;
    x /= count;
    double tt = 0, tx = 0;
    for (int f = first; f <= last; ++f) {
      if (std::isnan(positions(row, f))) continue;
      tt += (times[f] - t) * (times[f] - t);
      tx += (times[f] - t) * (positions(row, f) - x);
    }
    const double slope = tx / tt;
    for (int f = first; f <= last; ++f) {
      if (std::isnan(positions(row, f))) continue;
      const double miss = positions(row, f) - x - slope * (times[f] - t);
      squares += miss * miss;
    }
    freedom += count - 2;
    slopes += slope * slope;
    slope_variances += 1 / tt;
    ++rows;
  }
  if (rows == 0) return span;
  span.deviation = std::sqrt(squares / freedom);
  std::vector<Eigen::Index> complete;
  for (Eigen::Index row = 0; row < positions.rows(); ++row)
    if (positions.row(row).segment(first, last - first + 1).allFinite()) complete.push_back(row);
  if (!complete.empty())
    span.deviation = DeviationAboutTrend(times.segment(first, last - first + 1),
                                         positions(complete, Eigen::seq(first, last)));
  span.drift = std::sqrt(3 * slopes / rows);
  span.noise_drift = span.deviation * std::sqrt(3 * slope_variances / rows);
  return span;
}

std::vector<StaticSpan> StaticSpans(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions,
                                    double threshold, int fewest) {
  CHECK_EQ(times.size(), positions.cols());
  CHECK_GE(fewest, 3);
  std::vector<StaticSpan> spans;
  const int frames = static_cast<int>(times.size());
  for (int first = 0; first + fewest <= frames;) {
    int end = first + 1;
    // The span also ends at a frame without a point in common with the first one (NaN).
    while (end < frames && RmsBetween(positions, first, end) <= threshold) ++end;
    if (end - first >= fewest) {
      // A motion begins and ends slowly, so that its first and last frames are within the
      // threshold.
      const int margin = std::max(0, std::min((end - first) / 6, (end - first - 3) / 2));
      StaticSpan span = MeasureSpan(times, positions, first + (first > 0 ? margin : 0),
                                    end - 1 - (end < frames ? margin : 0));
      span.first = first;
      span.last = end - 1;
      spans.push_back(span);
      first = end;
    } else {
      ++first;
    }
  }
  return spans;
}

Eigen::MatrixXd Displacements(const Eigen::MatrixXd& positions) {
  const Eigen::MatrixXd seen = PointLengths(positions);
  Eigen::MatrixXd displacements = Eigen::MatrixXd::Constant(seen.rows(), seen.cols(), kUnknown);
  for (Eigen::Index m = 0; m < seen.rows(); ++m) {
    Eigen::Index first = 0;
    while (first < seen.cols() && std::isnan(seen(m, first))) ++first;
    for (Eigen::Index f = first; f < seen.cols(); ++f)
      displacements(m, f) =
          (positions.col(f).segment<3>(3 * m) - positions.col(first).segment<3>(3 * m)).norm();
  }
  return displacements;
}

Eigen::MatrixXd Speeds(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions) {
  CHECK_EQ(times.size(), positions.cols());
  const Eigen::Index frames = positions.cols();
  if (frames < 2) return Eigen::MatrixXd::Constant(positions.rows() / 3, frames, kUnknown);
  Eigen::MatrixXd velocities(positions.rows(), frames);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const Eigen::Index before = std::max<Eigen::Index>(0, f - 1);
    const Eigen::Index after = std::min(frames - 1, f + 1);
    velocities.col(f) =
        (positions.col(after) - positions.col(before)) / (times[after] - times[before]);
  }
  return PointLengths(velocities);
}

std::vector<ResidualBin> BinnedResiduals(const Eigen::MatrixXd& variable,
                                         const Eigen::MatrixXd& lengths, int bins) {
  CHECK_GE(bins, 1);
  auto pairs = SeenPairs(variable, lengths);
  std::sort(pairs.begin(), pairs.end());
  std::vector<ResidualBin> result;
  for (size_t begin = 0; begin < pairs.size();) {
    const size_t bins_left = std::max<size_t>(1, bins - std::min<size_t>(bins, result.size()));
    const size_t share = (pairs.size() - begin + bins_left - 1) / bins_left;
    size_t end = std::min(pairs.size(), begin + share);
    while (end < pairs.size() && pairs[end].first == pairs[end - 1].first) ++end;
    ResidualBin bin{pairs[begin].first, pairs[end - 1].first};
    for (size_t k = begin; k < end; ++k) {
      bin.mean += pairs[k].first;
      bin.rms += pairs[k].second * pairs[k].second;
    }
    bin.points = static_cast<int>(end - begin);
    bin.mean /= bin.points;
    bin.rms = std::sqrt(bin.rms / bin.points);
    result.push_back(bin);
    begin = end;
  }
  return result;
}

double RankCorrelation(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  std::vector<double> first, second;
  for (const auto& [x, y] : SeenPairs(a, b)) {
    first.push_back(x);
    second.push_back(y);
  }
  if (first.size() < 3) return kUnknown;
  const Eigen::VectorXd x = Ranks(first), y = Ranks(second);
  const Eigen::VectorXd dx = x.array() - x.mean(), dy = y.array() - y.mean();
  const double norms = dx.norm() * dy.norm();
  return norms > 0 ? dx.dot(dy) / norms : kUnknown;
}

FrameSpan LongestSpanAbove(const Eigen::VectorXd& of_frames, double threshold, int largest_gap) {
  FrameSpan longest, run;
  int gap = 0;
  for (int f = 0; f < of_frames.size(); ++f) {
    if (std::isnan(of_frames[f])) continue;
    if (!(of_frames[f] > threshold)) {
      if (++gap > largest_gap) run = {};
      continue;
    }
    gap = 0;
    if (run.above == 0) run.first = f;
    run.last = f;
    if (++run.above > longest.above) longest = run;
  }
  return longest;
}

MeanVector MeanOver(const Eigen::MatrixXd& vectors, int first, int last) {
  CHECK_EQ(vectors.rows() % 3, 0);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double lengths = 0;
  int count = 0;
  for (int f = first; f <= last; ++f) {
    for (Eigen::Index m = 0; m < vectors.rows() / 3; ++m) {
      const Eigen::Vector3d vector = vectors.col(f).segment<3>(3 * m);
      if (vector.hasNaN()) continue;
      sum += vector;
      lengths += vector.norm();
      ++count;
    }
  }
  MeanVector mean;
  if (count > 0) mean.mean = sum / count;
  if (lengths > 0) mean.agreement = sum.norm() / lengths;
  return mean;
}

Repeatability CompareRepeats(const Eigen::VectorXd& first_times, const Eigen::MatrixXd& first,
                             const Eigen::VectorXd& second_times, const Eigen::MatrixXd& second,
                             double delay, double largest_delay) {
  CHECK_EQ(first.rows(), second.rows());
  constexpr int kFewest = 10;
  const auto compare_at = [&](double shift) {
    Eigen::MatrixXd between = Eigen::MatrixXd::Constant(first.rows(), first.cols(), kUnknown);
    Repeatability result;
    result.delay = shift;
    Eigen::VectorXd there;
    double noise_gain = 1, gains = 0;
    for (Eigen::Index f = 0; f < first.cols(); ++f) {
      if (!At(second_times, second, first_times[f] + shift, &there, &noise_gain)) continue;
      between.col(f) = there - first.col(f);
      gains += 0.5 * (1 + noise_gain);
      ++result.frames;
    }
    if (result.frames >= kFewest)
      result.distance = Rms(PointLengths(Centred(between))) / std::sqrt(gains / result.frames);
    return result;
  };
  // A delay with little overlap could appear best, so at least half of the initial overlap is
  // needed.
  const Repeatability start = compare_at(delay);
  Repeatability best = start;
  double reach = largest_delay;
  constexpr int kSteps = 20, kRefinements = 4;
  for (int round = 0; round < kRefinements; ++round) {
    const double centre = best.delay;
    for (int k = -kSteps; k <= kSteps; ++k) {
      const double shift =
          std::clamp(centre + reach * k / kSteps, delay - largest_delay, delay + largest_delay);
      const Repeatability tried = compare_at(shift);
      // Too few common frames at the nominal delay leave its distance unknown.
      const bool is_nearer = !std::isnan(tried.distance) && !(tried.distance >= best.distance);
      if (2 * tried.frames >= start.frames && is_nearer) best = tried;
    }
    reach /= 0.5 * kSteps;
  }
  return std::isnan(best.distance) ? Repeatability{} : best;
}

}  // namespace lacuna
