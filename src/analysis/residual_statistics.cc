#include "analysis/residual_statistics.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>

namespace lacuna {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// Rows minus the mean of what was seen of each; NaN stays.
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

double Median(std::vector<double> values) {
  if (values.empty()) return kUnknown;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

struct Products {
  double sum = 0, first_squares = 0, second_squares = 0;
  int count = 0;
  double Correlation() const {
    return first_squares > 0 && second_squares > 0 ? sum / std::sqrt(first_squares * second_squares)
                                                   : kUnknown;
  }
  void Add(double first, double second) {
    if (std::isnan(first) || std::isnan(second)) return;
    sum += first * second;
    first_squares += first * first;
    second_squares += second * second;
    ++count;
  }
};

Products LaggedProducts(const Eigen::MatrixXd& centred, Eigen::Index row, Eigen::Index lag) {
  Products products;
  for (Eigen::Index f = 0; f + lag < centred.cols(); ++f)
    products.Add(centred(row, f), centred(row, f + lag));
  return products;
}

// ρ_lag of one row; the denominator is over all frames seen.
double Autocorrelation(const Eigen::MatrixXd& centred, Eigen::Index row, Eigen::Index lag) {
  const double squares = LaggedProducts(centred, row, 0).sum;
  return squares > 0 ? LaggedProducts(centred, row, lag).sum / squares : kUnknown;
}

double PooledAutocorrelation(const Eigen::MatrixXd& centred, Eigen::Index lag) {
  double products = 0, squares = 0;
  for (Eigen::Index row = 0; row < centred.rows(); ++row) {
    products += LaggedProducts(centred, row, lag).sum;
    squares += LaggedProducts(centred, row, 0).sum;
  }
  return squares > 0 ? products / squares : kUnknown;
}

double CorrelationFrames(const Eigen::MatrixXd& centred) {
  const double fallen = std::exp(-1.0);
  double before = 1;
  for (Eigen::Index lag = 1; 2 * lag <= centred.cols(); ++lag) {
    const double here = PooledAutocorrelation(centred, lag);
    if (std::isnan(here)) return kUnknown;
    if (here <= fallen) return static_cast<double>(lag) - 1 + (before - fallen) / (before - here);
    before = here;
  }
  return kInfinity;
}

// Σ over the rows of Q; `known` has 0 where `seen` has.
double LjungBoxStatistic(const Eigen::MatrixXd& known, const Eigen::MatrixXd& seen, int lags) {
  const Eigen::ArrayXd squares = known.rowwise().squaredNorm();
  const Eigen::ArrayXd counts = seen.rowwise().sum();
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(known.rows());
  for (int lag = 1; lag <= lags; ++lag) {
    const Eigen::Index columns = known.cols() - lag;
    const Eigen::ArrayXd products =
        known.leftCols(columns).cwiseProduct(known.rightCols(columns)).rowwise().sum();
    const Eigen::ArrayXd pairs =
        seen.leftCols(columns).cwiseProduct(seen.rightCols(columns)).rowwise().sum();
    sum += (pairs > 0).select((products / squares).square() / pairs.max(1), 0);
  }
  return (sum * counts * (counts + 2)).sum();
}

// Fisher–Yates. Not std::shuffle, which may differ between standard libraries.
void Shuffle(std::vector<int>* order, std::mt19937* random) {
  for (size_t k = order->size(); k > 1; --k) std::swap((*order)[k - 1], (*order)[(*random)() % k]);
}

// Least squares over a logarithmic grid: the sum is smooth in ln ℓ, 2 % apart is near enough.
double FitCorrelationLength(const std::vector<PointPair>& pairs) {
  double smallest = kInfinity, largest = 0;
  for (const PointPair& pair : pairs) {
    if (std::isnan(pair.correlation) || pair.distance <= 0) continue;
    smallest = std::min(smallest, pair.distance);
    largest = std::max(largest, pair.distance);
  }
  if (largest == 0) return kUnknown;
  const double from = std::log(0.1 * smallest), to = std::log(10 * largest);
  const int steps = std::max(1, static_cast<int>((to - from) / 0.02));
  int best = 0;
  double best_sum = kInfinity;
  for (int k = 0; k <= steps; ++k) {
    const double length = std::exp(from + (to - from) * k / steps);
    double sum = 0;
    for (const PointPair& pair : pairs) {
      if (std::isnan(pair.correlation)) continue;
      const double miss = pair.correlation - std::exp(-pair.distance / length);
      sum += miss * miss;
    }
    if (sum < best_sum) {
      best_sum = sum;
      best = k;
    }
  }
  if (best == 0) return 0;
  if (best == steps) return kInfinity;
  return std::exp(from + (to - from) * best / steps);
}

double RmsBetween(const Eigen::MatrixXd& positions, Eigen::Index a, Eigen::Index b) {
  return Rms(PointLengths(positions.col(a) - positions.col(b)));
}

StaticSpan MeasureSpan(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions, int first,
                       int last) {
  StaticSpan span{first, last};
  double squares = 0, slopes = 0;
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
    ++rows;
  }
  if (rows == 0) return span;
  span.deviation = std::sqrt(squares / freedom);
  span.drift = std::sqrt(3 * slopes / rows);
  return span;
}

// Entries where neither is NaN.
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

// The rows at `time`, linear between frames; false outside them.
bool At(const Eigen::VectorXd& times, const Eigen::MatrixXd& rows, double time,
        Eigen::VectorXd* value) {
  const Eigen::Index count = times.size();
  if (count < 2 || time < times[0] || time > times[count - 1]) return false;
  const double* after = std::upper_bound(times.data(), times.data() + count - 1, time);
  const Eigen::Index next = std::max<Eigen::Index>(1, after - times.data());
  const double share = (time - times[next - 1]) / (times[next] - times[next - 1]);
  *value = (1 - share) * rows.col(next - 1) + share * rows.col(next);
  return true;
}

}  // namespace

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

double ChiSquareTail(double statistic, int degrees_of_freedom) {
  CHECK_GE(degrees_of_freedom, 1);
  if (std::isnan(statistic)) return kUnknown;
  if (statistic <= 0) return 1;
  const double half = 0.5 * statistic;
  const bool odd = degrees_of_freedom % 2 == 1;
  double tail = odd ? std::erfc(std::sqrt(half)) : 0;
  for (double power = odd ? 0.5 : 0; power < 0.5 * degrees_of_freedom - 0.25; power += 1)
    tail += std::exp(power * std::log(half) - half - std::lgamma(power + 1));
  return std::min(1.0, tail);
}

TimeWhiteness WhitenessInTime(const Eigen::MatrixXd& series) {
  constexpr int kFewest = 10, kLags = 10;
  constexpr double kWork = 5e8;  // multiplications, about half a second
  const Eigen::MatrixXd centred = Centred(series);
  std::vector<Eigen::Index> rows;
  int most = 0;
  for (Eigen::Index row = 0; row < centred.rows(); ++row) {
    const Products all = LaggedProducts(centred, row, 0);
    if (all.count < kFewest || all.sum == 0) continue;
    rows.push_back(row);
    most = std::max(most, all.count);
  }
  TimeWhiteness whiteness;
  if (rows.empty()) return whiteness;
  whiteness.lags = std::min(kLags, most / 5);
  whiteness.lag_one = PooledAutocorrelation(centred, 1);
  whiteness.correlation_frames = CorrelationFrames(centred);

  const Eigen::MatrixXd chosen = centred(rows, Eigen::all);
  const Eigen::MatrixXd seen =
      chosen.array().isNaN().select(0.0, Eigen::MatrixXd::Ones(chosen.rows(), chosen.cols()));
  const Eigen::MatrixXd known = chosen.array().isNaN().select(0.0, chosen);
  whiteness.statistic = LjungBoxStatistic(known, seen, whiteness.lags);
  const double cost = 1.0 * static_cast<double>(known.size()) * whiteness.lags;
  const int trials = static_cast<int>(std::clamp(kWork / cost, 199.0, 999.0));
  std::vector<int> order(static_cast<size_t>(known.cols()));
  std::iota(order.begin(), order.end(), 0);
  std::mt19937 random(1);
  int as_large = 0;
  for (int trial = 0; trial < trials; ++trial) {
    Shuffle(&order, &random);
    as_large += LjungBoxStatistic(known(Eigen::all, order), seen(Eigen::all, order),
                                  whiteness.lags) >= whiteness.statistic;
  }
  whiteness.p_value = (1.0 + as_large) / (1.0 + trials);
  return whiteness;
}

SpaceWhiteness WhitenessInSpace(const Eigen::MatrixXd& vectors, const Eigen::Matrix3Xd& places) {
  CHECK_EQ(vectors.rows(), 3 * places.cols());
  constexpr int kFewest = 10;
  const Eigen::MatrixXd centred = Centred(vectors);
  std::vector<double> lag_one;
  for (Eigen::Index row = 0; row < centred.rows(); ++row)
    lag_one.push_back(Autocorrelation(centred, row, 1));
  SpaceWhiteness whiteness;
  double statistic = 0, sum = 0;
  int freedom = 0, known = 0;
  for (int i = 0; i < places.cols(); ++i) {
    for (int j = i + 1; j < places.cols(); ++j) {
      Products of_pair;
      for (int axis = 0; axis < 3; ++axis) {
        Products products;
        for (Eigen::Index f = 0; f < centred.cols(); ++f) {
          products.Add(centred(3 * i + axis, f), centred(3 * j + axis, f));
          of_pair.Add(centred(3 * i + axis, f), centred(3 * j + axis, f));
        }
        const double correlation = products.Correlation();
        if (products.count < kFewest || std::isnan(correlation)) continue;
        const double memory = std::clamp(lag_one[3 * i + axis] * lag_one[3 * j + axis], 0.0, 1.0);
        // The means taken away cost one frame.
        const double independent = (products.count - 1) * (1 - memory) / (1 + memory);
        statistic += independent * correlation * correlation;
        ++freedom;
      }
      PointPair pair{i, j, (places.col(i) - places.col(j)).norm()};
      if (of_pair.count >= 3 * kFewest) pair.correlation = of_pair.Correlation();
      if (!std::isnan(pair.correlation)) {
        sum += pair.correlation;
        ++known;
      }
      whiteness.pairs.push_back(pair);
    }
  }
  if (known > 0) {
    whiteness.mean_correlation = sum / known;
    whiteness.correlation_length = FitCorrelationLength(whiteness.pairs);
  }
  if (freedom > 0) whiteness.p_value = ChiSquareTail(statistic, freedom);
  return whiteness;
}

double WhiteNoise(const Eigen::MatrixXd& positions) {
  std::vector<double> of_rows;
  for (Eigen::Index row = 0; row < positions.rows(); ++row) {
    std::vector<double> second;
    for (Eigen::Index f = 1; f + 1 < positions.cols(); ++f) {
      const double value = positions(row, f - 1) - 2 * positions(row, f) + positions(row, f + 1);
      if (!std::isnan(value)) second.push_back(std::abs(value));
    }
    if (!second.empty()) of_rows.push_back(Median(std::move(second)) / (0.6745 * std::sqrt(6.0)));
  }
  return Median(std::move(of_rows));
}

std::vector<StaticSpan> StaticSpans(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions,
                                    double threshold, int fewest) {
  CHECK_EQ(times.size(), positions.cols());
  CHECK_GE(fewest, 3);
  std::vector<StaticSpan> spans;
  const int frames = static_cast<int>(times.size());
  for (int first = 0; first + fewest <= frames;) {
    int end = first + 1;
    // A frame that shares no point with the first tells nothing of motion: it ends the span.
    while (end < frames && RmsBetween(positions, first, end) <= threshold) ++end;
    if (end - first >= fewest) {
      spans.push_back(MeasureSpan(times, positions, first, end - 1));
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
    const size_t left = std::max<size_t>(1, bins - std::min<size_t>(bins, result.size()));
    const size_t share = (pairs.size() - begin + left - 1) / left;
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
  const auto differ = [&](double by) {
    Eigen::MatrixXd between = Eigen::MatrixXd::Constant(first.rows(), first.cols(), kUnknown);
    Repeatability result;
    result.delay = by;
    Eigen::VectorXd there;
    for (Eigen::Index f = 0; f < first.cols(); ++f) {
      if (!At(second_times, second, first_times[f] + by, &there)) continue;
      between.col(f) = there - first.col(f);
      ++result.frames;
    }
    if (result.frames >= kFewest) result.distance = Rms(PointLengths(Centred(between)));
    return result;
  };
  // A delay at which little overlaps would look best: at least half of what overlaps at the start.
  const Repeatability start = differ(delay);
  Repeatability best = start;
  double reach = largest_delay;
  constexpr int kSteps = 20, kRefinements = 4;
  for (int round = 0; round < kRefinements; ++round) {
    const double centre = best.delay;
    for (int k = -kSteps; k <= kSteps; ++k) {
      const double by =
          std::clamp(centre + reach * k / kSteps, delay - largest_delay, delay + largest_delay);
      const Repeatability tried = differ(by);
      if (2 * tried.frames >= start.frames && tried.distance < best.distance) best = tried;
    }
    reach /= kSteps / 2;
  }
  return std::isnan(best.distance) ? Repeatability{} : best;
}

}  // namespace lacuna
