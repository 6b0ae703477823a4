#include "analysis/positive_normal.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "analysis/non_negative_minimum.h"
#include "analysis/normal_distribution.h"
#include "core/random_bits.h"

namespace lacuna {
namespace {

// A draw from the standard normal distribution truncated to values of at least `least` (Robert,
// Simulation of truncated normal variables, Statistics and Computing 5, 1995).
double NormalAbove(double least, uint64_t bits) {
  CHECK(std::isfinite(least));
  const double rate = 0.5 * (least + std::hypot(least, 2.0));
  for (uint64_t attempt = 0;; ++attempt) {
    const uint64_t proposal = RandomBits({bits, attempt, 0});
    const double value = least <= 0 ? Normal(proposal) : least - std::log(Uniform(proposal)) / rate;
    if (value < least) continue;
    if (least <= 0 ||
        Uniform(RandomBits({bits, attempt, 1})) <= std::exp(-0.5 * (value - rate) * (value - rate)))
      return value;
  }
}

// ∫ exp(f) from `low` to `high`, by a Gauss–Legendre rule of 16 points.
template <typename LogFunction>
double IntegralOfExp(double low, double high, const LogFunction& f) {
  struct Point {
    double place, weight;
  };
  constexpr std::array<Point, 8> kRule{{{0.98940093499164993, 0.027152459411754095},
                                        {0.94457502307323258, 0.062253523938647893},
                                        {0.86563120238783174, 0.095158511682492785},
                                        {0.75540440835500303, 0.12462897125553387},
                                        {0.61787624440264375, 0.14959598881657673},
                                        {0.45801677765722739, 0.16915651939500254},
                                        {0.28160355077925891, 0.18260341504492359},
                                        {0.095012509837637440, 0.18945061045506850}}};
  const double middle = 0.5 * (low + high), half = 0.5 * (high - low);
  double sum = 0;
  for (const Point& point : kRule)
    sum += point.weight *
           (std::exp(f(middle - half * point.place)) + std::exp(f(middle + half * point.place)));
  return half * sum;
}

// Two amounts as in positive_normal.h, in units of their deviations.
class PositivePair {
 public:
  PositivePair(const Eigen::Vector2d& mean, const Eigen::Matrix2d& covariance)
      : deviations_(covariance.diagonal().cwiseSqrt()),
        a_(mean[0] / deviations_[0]),
        b_(mean[1] / deviations_[1]),
        correlation_(std::clamp(covariance(0, 1) / (deviations_[0] * deviations_[1]), -1.0, 1.0)),
        // What is smaller is rounding of the correlation.
        rest_(std::max(1e-7, std::sqrt((1 - correlation_) * (1 + correlation_)))) {
    FindMode();
    Integrate();
  }

  // ln P(x > 0)
  double LogProbability() const { return log_probability_; }

  Eigen::Vector2d Draw(uint64_t bits) const {
    const double first = DrawFirst(RandomBits({bits, 0}));
    const double mean = b_ + correlation_ * (first - a_);
    const double second = mean + rest_ * NormalAbove(-mean / rest_, RandomBits({bits, 1}));
    return deviations_.cwiseProduct(Eigen::Vector2d(first, second));
  }

 private:
  // The argument of Φ.
  double Slack(double u) const { return (b_ + correlation_ * (u - a_)) / rest_; }

  // The logarithm of the integrand, without 1/√2π. Its second derivative is between −1/(1 − ρ²) and
  // −1.
  double LogDensity(double u) const { return -0.5 * (u - a_) * (u - a_) + LogNormal(Slack(u)); }
  double Slope(double u) const {
    return a_ - u + correlation_ / rest_ * InverseMillsRatio(Slack(u));
  }

  // The largest value of the integrand for u ≥ 0, by bisection. The upper end follows from the
  // inverse Mills ratio, which is at most max(0, −z) + 1.
  void FindMode() {
    mode_ = 0;
    if (Slope(0) > 0) {
      double low = 0, high = std::max(a_, 0.0);
      if (correlation_ > 0) high += correlation_ / rest_ * (std::max(0.0, -b_) / rest_ + 1);
      while (high - low > std::max(1e-6 * rest_, 1e-15 * high)) {
        const double middle = 0.5 * (low + high);
        (Slope(middle) > 0 ? low : high) = middle;
      }
      mode_ = 0.5 * (low + high);
    }
    peak_ = LogDensity(mode_);
  }

  // How far from the mode, in a direction, the integrand is negligible.
  double Reach(double direction) const {
    constexpr double kNegligible = 36;  // e⁻³⁶ is the rounding of a double
    // From here on, at the earliest, by the bound of the second derivative.
    const double slope = std::max(0.0, -direction * Slope(mode_));
    double reach =
        2 * kNegligible / (slope + std::sqrt(slope * slope + 2 * kNegligible / (rest_ * rest_)));
    while (LogDensity(mode_ + direction * reach) > peak_ - kNegligible) reach *= 2;
    return reach;
  }

  void Integrate() {
    const double low = std::max(0.0, mode_ - Reach(-1)), high = mode_ + Reach(1);
    std::vector<double> ends = {low, mode_, high};
    if (correlation_ != 0)  // Φ rises within these
      for (const double slack : {-8, 0, 8})
        ends.push_back(std::clamp(a_ + (slack * rest_ - b_) / correlation_, low, high));
    std::sort(ends.begin(), ends.end());
    const auto relative = [&](double u) { return LogDensity(u) - peak_; };
    constexpr int kParts = 3;  // of each interval, so that the rule leaves an error of about 1e-15
    double sum = 0;
    for (size_t k = 1; k < ends.size(); ++k) {
      if (ends[k] == ends[k - 1]) continue;
      const double part = (ends[k] - ends[k - 1]) / kParts;
      for (int j = 0; j < kParts; ++j)
        sum += IntegralOfExp(ends[k - 1] + j * part, ends[k - 1] + (j + 1) * part, relative);
    }
    log_mass_ = std::log(sum);
    log_probability_ = peak_ + log_mass_ - 0.5 * std::log(2 * std::numbers::pi);
  }

  // By rejection: a log-concave density with the largest value M at m is at most
  // M min(1, exp(1 − M |u − m|)) (Devroye, Non-Uniform Random Variate Generation, 1986, VII.2).
  double DrawFirst(uint64_t bits) const {
    CHECK(std::isfinite(log_mass_));
    const double largest = std::exp(-log_mass_);
    for (uint64_t attempt = 0;; ++attempt) {
      const double share = 2 * Uniform(RandomBits({bits, attempt, 0}));
      const double distance = share < 1 ? share : 1 - std::log(2 - share);
      const double side = Uniform(RandomBits({bits, attempt, 1})) < 0.5 ? -1 : 1;
      const double value = mode_ + side * distance / largest;
      if (value >= 0 && std::log(Uniform(RandomBits({bits, attempt, 2}))) <=
                            LogDensity(value) - peak_ - std::min(0.0, 1 - distance))
        return value;
    }
  }

  Eigen::Vector2d deviations_;
  double a_, b_, correlation_, rest_;  // rest_: √(1 − ρ²)
  double mode_ = 0, peak_ = 0;         // of LogDensity()
  double log_mass_ = 0;                // ln ∫ exp(LogDensity() − peak_)
  double log_probability_ = 0;
};

// The distribution of the amounts k and l, given the others.
PositivePair Conditional(const Eigen::VectorXd& mean, const Eigen::MatrixXd& precision,
                         const Eigen::VectorXd& at, Eigen::Index k, Eigen::Index l) {
  const std::vector<Eigen::Index> both = {k, l};
  Eigen::VectorXd change = at - mean;
  change(both).setZero();
  const Eigen::Matrix2d covariance = Eigen::Matrix2d(precision(both, both)).inverse();
  const Eigen::Vector2d toward = precision(both, Eigen::all) * change;
  return {Eigen::Vector2d(mean(both)) - covariance * toward, covariance};
}

}  // namespace

double LogOrthantFactor(Eigen::VectorXd mean, Eigen::MatrixXd covariance) {
  double factor = 0;
  Eigen::Index left = mean.size();
  for (; left > 2; --left) {
    const double deviation = std::sqrt(covariance(0, 0)), z = mean[0] / deviation;
    factor += LogTwiceNormal(z);
    // Conditioned on the first one, which then has the mean z + ratio and the variance
    // 1 − ratio (z + ratio) in units of its deviation.
    const double ratio = InverseMillsRatio(z);
    const Eigen::VectorXd gain = covariance.col(0).tail(left - 1) / deviation;
    mean = (mean.tail(left - 1) + ratio * gain).eval();
    covariance = (covariance.bottomRightCorner(left - 1, left - 1) -
                  ratio * (z + ratio) * gain * gain.transpose())
                     .eval();
  }
  if (left == 2)
    return factor + 2 * std::numbers::ln2 + PositivePair(mean, covariance).LogProbability();
  return left == 1 ? LogTwiceNormal(mean[0] / std::sqrt(covariance(0, 0))) : 0;
}

Eigen::VectorXd DrawPositive(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                             uint64_t bits) {
  const Eigen::Index size = mean.size();
  if (size == 1) {
    const double deviation = std::sqrt(covariance(0, 0));
    return mean.array() + deviation * NormalAbove(-mean[0] / deviation, bits);
  }
  if (size == 2) return PositivePair(mean, covariance).Draw(bits);
  constexpr uint64_t kSweeps = 50;
  const Eigen::MatrixXd precision = covariance.ldlt().solve(Eigen::MatrixXd::Identity(size, size));
  Eigen::VectorXd drawn = mean.cwiseMax(0);
  for (uint64_t sweep = 0; sweep < kSweeps; ++sweep)
    for (Eigen::Index k = 0; k < size; ++k) {
      const Eigen::Index next = (k + 1) % size;
      const Eigen::Vector2d both = Conditional(mean, precision, drawn, k, next)
                                       .Draw(RandomBits({bits, sweep, static_cast<uint64_t>(k)}));
      drawn[k] = both[0];
      drawn[next] = both[1];
    }
  return drawn;
}

Eigen::VectorXd PositiveMode(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance,
                             const std::vector<Eigen::Index>& positive) {
  const auto minimize = [&](const std::vector<Eigen::Index>& zeros) {
    // The least (x − m)ᵀ C⁻¹ (x − m) where these are 0.
    const Eigen::VectorXd removed = mean(zeros);
    const Eigen::VectorXd multipliers =
        Eigen::MatrixXd(covariance(zeros, zeros)).ldlt().solve(removed);
    MinimumWithZeros minimum;
    minimum.at = mean - covariance(Eigen::all, zeros) * multipliers;
    minimum.at(zeros).setZero();
    minimum.slopes = -multipliers.cwiseProduct(covariance.diagonal()(zeros).cwiseSqrt());
    minimum.value = removed.dot(multipliers);
    return minimum;
  };
  return MinimizeNonNegative(minimize, positive).at;
}

}  // namespace lacuna
