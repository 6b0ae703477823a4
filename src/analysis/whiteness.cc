#include "analysis/whiteness.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "analysis/residual_statistics.h"

namespace lacuna {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr int kFewestFrames = 10;  // of a row that is tested
// Multiplications of one randomisation test, about half a second. More: p-values of long series are
// known better, and a comparison takes longer.
constexpr double kWork = 5e8;
// Limits of the number of random arrangements. With the fewest, a p-value of 0.05 has a standard
// error of 0.015, with the most one of 0.007.
constexpr double kFewestTrials = 199, kMostTrials = 999;

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

// Q summed over the rows. `seen` is 1 where an entry was seen and 0 elsewhere, where `known` is 0
// too.
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

// A Fisher–Yates shuffle. std::shuffle may differ between standard libraries.
void Shuffle(std::vector<int>* order, std::mt19937* random) {
  for (size_t k = order->size(); k > 1; --k) std::swap((*order)[k - 1], (*order)[(*random)() % k]);
}

// The p-value of a randomisation test: the share of the random arrangements of the data whose
// statistic, arranged(&random), is at least that of the data, which counts as one of them. `cost`:
// multiplications of one statistic. Every call uses the same random numbers.
template <typename Arranged>
double RandomisationProbability(double observed, double cost, const Arranged& arranged) {
  const int trials = static_cast<int>(std::clamp(kWork / cost, kFewestTrials, kMostTrials));
  std::mt19937 random(1);
  int as_large = 0;
  for (int trial = 0; trial < trials; ++trial) as_large += arranged(&random) >= observed;
  return (1.0 + as_large) / (1.0 + trials);
}

// One row per point; its shifts copy contiguous numbers.
using PointRows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// For each component of the points (m rows, n columns): the centred rows, 0 where an entry is not
// known, scaled so that n' ρ² of two points is the square of the product of their rows; n' is the
// geometric mean of their numbers of known entries. Rows with too few entries are 0. Of many points
// an even selection is taken, because the work grows with their square.
std::vector<PointRows> PointsByAxis(const Eigen::MatrixXd& centred, Eigen::Index components) {
  constexpr Eigen::Index kMostPoints = 100;
  const Eigen::Index all = centred.rows() / components, points = std::min(all, kMostPoints);
  std::vector<PointRows> axes(static_cast<size_t>(components),
                              PointRows::Zero(points, centred.cols()));
  for (Eigen::Index axis = 0; axis < components; ++axis) {
    for (Eigen::Index k = 0; k < points; ++k) {
      const Eigen::RowVectorXd row = centred.row(components * (k * all / points) + axis);
      const double seen = static_cast<double>((!row.array().isNaN()).count());
      const Eigen::RowVectorXd known = row.array().isNaN().select(0.0, row);
      if (seen >= kFewestFrames && known.norm() > 0)
        axes[static_cast<size_t>(axis)].row(k) = known * (std::pow(seen, 0.25) / known.norm());
    }
  }
  return axes;
}

// Σ n' ρ² over all ordered pairs and axes, those of a point with itself included: the squared norm
// of X Xᵀ, which Xᵀ X has too.
double SumOfSquaredCorrelations(const std::vector<PointRows>& axes) {
  double sum = 0;
  for (const PointRows& points : axes)
    sum += points.rows() < points.cols() ? (points * points.transpose()).squaredNorm()
                                         : (points.transpose() * points).squaredNorm();
  return sum;
}

// The p-value of the test by random circular shifts.
double ProbabilityByShifts(const std::vector<PointRows>& axes) {
  const Eigen::Index points = axes.front().rows(), frames = axes.front().cols();
  const double cost = static_cast<double>(axes.size()) *
                      static_cast<double>(points * frames * std::min(points, frames));
  std::vector<PointRows> shifted = axes;
  return RandomisationProbability(SumOfSquaredCorrelations(axes), cost, [&](std::mt19937* random) {
    for (Eigen::Index k = 0; k < points; ++k) {
      const Eigen::Index lag = static_cast<Eigen::Index>((*random)()) % frames;
      for (size_t axis = 0; axis < axes.size(); ++axis) {
        shifted[axis].row(k).head(lag) = axes[axis].row(k).tail(lag);
        shifted[axis].row(k).tail(frames - lag) = axes[axis].row(k).head(frames - lag);
      }
    }
    return SumOfSquaredCorrelations(shifted);
  });
}

// Least squares over a logarithmic grid. The sum is smooth in ln ℓ, so a spacing of 2 % suffices.
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

}  // namespace

double ChiSquareTail(double statistic, int degrees_of_freedom) {
  CHECK_GE(degrees_of_freedom, 1);
  if (std::isnan(statistic)) return kUnknown;
  if (statistic <= 0) return 1;
  if (std::isinf(statistic)) return 0;
  const double half = 0.5 * statistic;
  const bool odd = degrees_of_freedom % 2 == 1;
  double tail = odd ? std::erfc(std::sqrt(half)) : 0;
  for (int k = 0; k < degrees_of_freedom / 2; ++k) {
    const double power = odd ? k + 0.5 : k;
    tail += std::exp(power * std::log(half) - half - std::lgamma(power + 1));
  }
  return std::min(1.0, tail);
}

TimeWhiteness WhitenessInTime(const Eigen::MatrixXd& series) {
  constexpr int kLags = 10;
  const Eigen::MatrixXd centred = Centred(series);
  std::vector<Eigen::Index> rows;
  int most = 0;
  for (Eigen::Index row = 0; row < centred.rows(); ++row) {
    const Products all = LaggedProducts(centred, row, 0);
    if (all.count < kFewestFrames || all.sum == 0) continue;
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
  std::vector<int> order(static_cast<size_t>(known.cols()));
  std::iota(order.begin(), order.end(), 0);
  whiteness.p_value =
      RandomisationProbability(whiteness.statistic, cost, [&](std::mt19937* random) {
        Shuffle(&order, random);
        return LjungBoxStatistic(known(Eigen::all, order), seen(Eigen::all, order), whiteness.lags);
      });
  return whiteness;
}

SpaceWhiteness WhitenessInSpace(const Eigen::MatrixXd& vectors, const Eigen::Matrix3Xd& places) {
  if (places.cols() == 0) return {};
  CHECK_EQ(vectors.rows() % places.cols(), 0);
  const Eigen::MatrixXd centred = Centred(vectors);
  const Eigen::Index components = vectors.rows() / places.cols();
  SpaceWhiteness whiteness;
  double sum = 0;
  int known = 0;
  for (int i = 0; i < places.cols(); ++i) {
    for (int j = i + 1; j < places.cols(); ++j) {
      Products of_pair;
      for (Eigen::Index axis = 0; axis < components; ++axis)
        for (Eigen::Index f = 0; f < centred.cols(); ++f)
          of_pair.Add(centred(components * i + axis, f), centred(components * j + axis, f));
      PointPair pair{i, j, (places.col(i) - places.col(j)).norm()};
      if (of_pair.count >= components * kFewestFrames) pair.correlation = of_pair.Correlation();
      if (!std::isnan(pair.correlation)) {
        sum += pair.correlation;
        ++known;
      }
      whiteness.pairs.push_back(pair);
    }
  }
  if (known == 0) return whiteness;
  whiteness.mean_correlation = sum / known;
  whiteness.correlation_length = FitCorrelationLength(whiteness.pairs);
  whiteness.p_value = ProbabilityByShifts(PointsByAxis(centred, components));
  return whiteness;
}

}  // namespace lacuna
