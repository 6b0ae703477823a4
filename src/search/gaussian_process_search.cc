#include "search/gaussian_process_search.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "search/cobyla.h"
#include "search/evaluator.h"
#include "search/gaussian_process.h"

namespace lacuna {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr std::array<int, 10> kPrimes = {2, 3, 5, 7, 11, 13, 17, 19, 23, 29};

// The Halton sequence (1960): the digits of `index` in base `base`, reflected at the radix point.
double Halton(int index, int base) {
  double value = 0, digit = 1.0 / base;
  for (; index > 0; index /= base, digit /= base) value += digit * (index % base);
  return value;
}

// The generator SplitMix64 (Steele, Lea and Flood 2014). Uniform() is in [0, 1).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  double Uniform() {
    uint64_t z = state_ += 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return static_cast<double>((z ^ (z >> 31)) >> 11) * 0x1.0p-53;
  }
  // Approximately normal with mean 0 and standard deviation 1: a sum of twelve uniform numbers.
  double Normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += Uniform();
    return sum;
  }

 private:
  uint64_t state_;
};

// The logarithm of the expected improvement below `least`.
double LogImprovement(const GaussianProcess::Prediction& prediction, double least) {
  const double deviation = std::max(prediction.deviation, 1e-12);
  const double z = (least - prediction.mean) / deviation;
  // Asymptotic expansion for large -z, where the formula below would underflow.
  if (z < -6) return std::log(deviation) - 0.5 * z * z - 2 * std::log(-z) - 0.919;
  const double density = 0.3989422804014327 * std::exp(-0.5 * z * z);
  return std::log(deviation * (z * 0.5 * std::erfc(-z * 0.7071067811865476) + density));
}

class GaussianProcessSearch {
 public:
  GaussianProcessSearch(const GaussianProcessSearchOptions& options, Evaluator* evaluator)
      : options_(options), evaluator_(*evaluator), random_(options.seed) {
    scales_.log_lengths = VectorXd::Constant(evaluator->n(), std::log(0.5));
  }

  void Run(int max_evaluations) {
    const int n = evaluator_.n();
    const int initial = options_.initial_points > 0 ? options_.initial_points : n + 2;
    Observe(ToUnit(evaluator_.start()));
    for (int i = 1; i < initial && !evaluator_.stopped(); ++i) {
      VectorXd u(n);
      for (int k = 0; k < n; ++k) u[k] = Halton(i, kPrimes[k]);
      Observe(u);
    }
    for (int i = 0; i < 2 * max_evaluations && !evaluator_.stopped(); ++i) Observe(Propose());
  }

 private:
  VectorXd ToUnit(const VectorXd& x) const {
    return (x - evaluator_.lower()).cwiseQuotient(evaluator_.upper() - evaluator_.lower());
  }

  void Observe(const VectorXd& u) {
    const VectorXd x = evaluator_.Within(evaluator_.lower() +
                                         u.cwiseProduct(evaluator_.upper() - evaluator_.lower()));
    const int before = evaluator_.evaluation_count();
    const Evaluation* outcome = evaluator_.At(x);
    if (outcome == nullptr || evaluator_.evaluation_count() == before) return;
    points_.push_back(u);
    values_.push_back(outcome->value);
  }

  // The values of all points, standardised to mean 0 and variance 1.
  VectorXd Values() const {
    std::vector<double> sorted;
    for (const std::optional<double>& value : values_) {
      if (value) sorted.push_back(*value);
    }
    std::sort(sorted.begin(), sorted.end());
    const double failed = sorted[3 * (sorted.size() - 1) / 4];
    VectorXd result(values_.size());
    double mean = 0, variance = 0;
    for (size_t i = 0; i < values_.size(); ++i) {
      result[i] = values_[i].value_or(failed);
      mean += result[i] / static_cast<double>(values_.size());
    }
    for (double& value : result) {
      value -= mean;
      variance += value * value / static_cast<double>(values_.size());
    }
    return result / std::sqrt(std::max(variance, 1e-300));
  }

  VectorXd Propose() {
    const int n = evaluator_.n();
    const auto any_point = [&] {
      VectorXd u(n);
      for (double& coordinate : u) coordinate = random_.Uniform();
      return u;
    };
    if (evaluator_.best() < 0) return any_point();
    MatrixXd points(n, points_.size());
    for (size_t j = 0; j < points_.size(); ++j) points.col(j) = points_[j];
    const VectorXd values = Values();
    scales_ = FitScales(points, values, scales_, options_.likelihoods);
    const GaussianProcess process(points, values, scales_);
    if (!std::isfinite(process.LogLikelihood())) return any_point();

    double least = std::numeric_limits<double>::infinity();
    VectorXd centre;
    for (const VectorXd& point : points_) {
      const double mean = process.At(point).mean;
      if (mean < least) {
        least = mean;
        centre = point;
      }
    }
    VectorXd best = any_point();
    double best_improvement = LogImprovement(process.At(best), least);
    for (int i = 1; i < options_.candidates; ++i) {
      VectorXd u = any_point();
      if (i % 2 == 0) {
        const double spread = i % 4 == 0 ? 0.1 : 0.02;
        for (int k = 0; k < n; ++k) {
          u[k] = std::clamp(centre[k] + spread * random_.Normal(), 0.0, 1.0);
        }
      }
      const double improvement = LogImprovement(process.At(u), least);
      if (improvement > best_improvement) {
        best_improvement = improvement;
        best = u;
      }
    }
    return Refined(process, least, best);
  }

  VectorXd Refined(const GaussianProcess& process, double least, const VectorXd& from) const {
    SearchProblem problem;
    problem.lower = VectorXd::Zero(from.size());
    problem.upper = VectorXd::Ones(from.size());
    problem.start = from;
    problem.evaluate = [&](const VectorXd& u) {
      Evaluation outcome;
      outcome.value = -LogImprovement(process.At(u), least);
      return outcome;
    };
    SearchControl control;
    control.max_evaluations = 80;
    CobylaOptions options;
    options.initial_radius = 0.03;
    options.final_radius = 1e-3;
    return MinimiseByCobyla(problem, control, options).x();
  }

  const GaussianProcessSearchOptions& options_;
  Evaluator& evaluator_;
  Random random_;
  GaussianProcessScales scales_;
  std::vector<VectorXd> points_;  // in the unit cube
  std::vector<std::optional<double>> values_;
};

}  // namespace

SearchResult MinimiseByGaussianProcess(const SearchProblem& problem, const SearchControl& control,
                                       const GaussianProcessSearchOptions& options) {
  CHECK_EQ(problem.constraint_count, 0);
  Evaluator evaluator(problem, control,
                      fmt::format("gaussian process {} {} {} {}", options.initial_points,
                                  options.candidates, options.likelihoods, options.seed));
  CHECK_LE(evaluator.n(), static_cast<int>(kPrimes.size()));
  CHECK(evaluator.lower().allFinite() && evaluator.upper().allFinite());
  if (std::optional<SearchResult> only = evaluator.FinishIfAllFixed()) return *std::move(only);
  GaussianProcessSearch(options, &evaluator).Run(control.max_evaluations);
  return evaluator.Finish(SearchStatus::kIterationLimit);
}

}  // namespace lacuna
