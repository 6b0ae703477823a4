#include "search/gaussian_process.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <set>
#include <vector>

#include "search/gaussian_process_search.h"
#include "search/problem_collection.h"

namespace lacuna {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// Eq. 2.25 and 2.26 of Rasmussen and Williams by dense inversion.
TEST(GaussianProcess, AgreesWithTheFormulas) {
  const int count = 7;
  MatrixXd points(2, count);
  VectorXd values(count);
  for (int j = 0; j < count; ++j) {
    points.col(j) << UniformOf(j), UniformOf(100 + j);
    values[j] = std::sin(5 * points(0, j)) - points(1, j);
  }
  const GaussianProcessScales scales{Eigen::Vector2d(std::log(0.4), std::log(0.9)), std::log(1e-3)};
  const auto kernel = [&](const VectorXd& a, const VectorXd& b) {
    const double r = std::sqrt(5.0) * (a - b).cwiseQuotient(Eigen::Vector2d(0.4, 0.9)).norm();
    return (1 + r + r * r / 3) * std::exp(-r);
  };
  MatrixXd covariance(count, count);
  VectorXd across(count);
  const VectorXd x = Eigen::Vector2d(0.3, 0.6);
  for (int j = 0; j < count; ++j) {
    across[j] = kernel(points.col(j), x);
    for (int i = 0; i < count; ++i) covariance(i, j) = kernel(points.col(i), points.col(j));
    covariance(j, j) += 1e-3;
  }
  const MatrixXd inverse = covariance.inverse();
  const double variance = values.dot(inverse * values) / count;
  const GaussianProcess process(points, values, scales);
  const GaussianProcess::Prediction prediction = process.At(x);
  // Rounding errors times the condition number of about 1e4.
  EXPECT_NEAR(prediction.mean, across.dot(inverse * values), 1e-10);
  EXPECT_NEAR(prediction.deviation, std::sqrt(variance * (1 - across.dot(inverse * across))), 1e-9);
  EXPECT_NEAR(process.LogLikelihood(),
              -0.5 * count * std::log(variance) - 0.5 * std::log(covariance.determinant()), 1e-9);
}

TEST(GaussianProcess, FindsTheIrrelevantVariableAndTheNoise) {
  const int count = 40;
  MatrixXd points(2, count);
  VectorXd values(count);
  for (int j = 0; j < count; ++j) {
    points.col(j) << UniformOf(j), UniformOf(100 + j);
    values[j] = 1.5 * std::sin(6 * points(0, j)) + 0.2 * (UniformOf(200 + j) - 0.5);
  }
  GaussianProcessScales first;
  first.log_lengths = VectorXd::Constant(2, std::log(0.5));
  const GaussianProcessScales scales = FitScales(points, values, first, 200);
  EXPECT_GT(scales.log_lengths[1], scales.log_lengths[0] + 1);
  // The noise has the variance 0.0033 and the signal about 1; forty points determine the ratio to
  // within a factor of ten.
  EXPECT_NEAR(scales.log_noise, std::log(0.0033), std::log(10.0));
}

TEST(GaussianProcessSearch, FindsANoisyValleyWithAndWithoutFailures) {
  for (const double failing : {0.0, 0.03}) {
    for (uint64_t seed = 1; seed <= 2; ++seed) {
      const SteppedProblem stepped = MakeSteppedProblem(0.01, failing, seed);
      SearchControl control;
      control.max_evaluations = 60;
      const SearchResult result = MinimiseByGaussianProcess(stepped.problem, control, {});
      EXPECT_EQ(result.trace.size(), 60);
      EXPECT_EQ(result.status, SearchStatus::kEvaluations);
      std::set<std::vector<double>> seen;
      for (const SearchStep& step : result.trace) {
        EXPECT_TRUE((step.x.array() >= 0).all() && (step.x.array() <= 1).all());
        EXPECT_TRUE(seen.emplace(step.x.begin(), step.x.end()).second);
      }
      EXPECT_LT(stepped.smooth(result.x()), 0.02);  // twice the noise; the start is at 0.13
      EXPECT_EQ(MinimiseByGaussianProcess(stepped.problem, control, {}).trace_hash,
                result.trace_hash);
    }
  }
}

TEST(GaussianProcessSearch, EndsIfEverythingFailsOrIsEqual) {
  for (const bool fails : {false, true}) {
    SearchProblem problem = MakeSteppedProblem(0, 0, 1).problem;
    problem.evaluate = [fails](const VectorXd&) {
      return fails ? Evaluation{{}, {}, "refused"} : Evaluation{1.0, {}, ""};
    };
    SearchControl control;
    control.max_evaluations = 20;
    const SearchResult result = MinimiseByGaussianProcess(problem, control, {});
    EXPECT_EQ(result.trace.size(), 20);
    EXPECT_EQ(result.IsUsable(), !fails);
  }
}

}  // namespace
}  // namespace lacuna
