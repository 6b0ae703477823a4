#include "analysis/amplitude_estimate.h"

#include <gtest/gtest.h>

#include <random>

namespace lacuna {
namespace {

constexpr int kRows = 400, kAmplitudes = 10;

struct Case {
  Eigen::MatrixXd by;
  Eigen::VectorXd truth, residual;
};

// Amplitudes of deviation `width`, seen through noise of deviation `noise`.
Case MakeCase(double width, double noise, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](Eigen::Index rows, Eigen::Index columns) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  };
  Case made;
  made.by = draw(kRows, kAmplitudes);
  made.truth = width * draw(kAmplitudes, 1);
  made.residual = noise * draw(kRows, 1) - made.by * made.truth;
  return made;
}

const std::vector<Eigen::MatrixXd> kAlike{Eigen::MatrixXd::Identity(kAmplitudes, kAmplitudes)};

AmplitudeEstimate Estimate(const Case& of, const std::vector<Eigen::MatrixXd>& shapes = kAlike) {
  return EstimateAmplitudes(FittedModel(of.residual, Eigen::MatrixXd(kRows, 0), Eigen::VectorXd()),
                            of.by, kRows, 1, shapes);
}

TEST(AmplitudeEstimate, CoversTheTruthAsOftenAsItsDeviationsSay) {
  int inside = 0;
  constexpr int kCases = 50;
  for (int seed = 0; seed < kCases; ++seed) {
    const Case of = MakeCase(0.5, 2, seed);
    const AmplitudeEstimate estimate = Estimate(of);
    EXPECT_NEAR(estimate.noise, 2, 0.3);  // 4 deviations of what 400 rows tell
    for (int k = 0; k < kAmplitudes; ++k)
      inside +=
          std::abs(estimate.mean[k] - of.truth[k]) < 1.96 * std::sqrt(estimate.covariance(k, k));
  }
  // 95 % of 500, ± 3 deviations of a binomial.
  EXPECT_NEAR(inside, 475, 15);
}

TEST(AmplitudeEstimate, SaysThatItSeesNothingWhereNothingIs) {
  for (int seed = 0; seed < 20; ++seed) {
    const Case of = MakeCase(0, 1, seed);
    const AmplitudeEstimate estimate = Estimate(of);
    EXPECT_LT(estimate.evidence, 4);  // e⁴: one case in fifty
    // Yet not that it is certain of that: the data tells each amplitude to 1/√400.
    EXPECT_GT(std::sqrt(estimate.covariance(0, 0)), 0.2 / std::sqrt(kRows));
    for (int k = 0; k < kAmplitudes; ++k)
      EXPECT_LT(std::abs(estimate.mean[k]), 4 * std::sqrt(estimate.covariance(k, k)));
  }
}

TEST(AmplitudeEstimate, TakesTheShapeOfPriorThatTheDataHas) {
  // All amplitudes equal, or each its own.
  Eigen::MatrixXd together = 0.01 * Eigen::MatrixXd::Identity(kAmplitudes, kAmplitudes);
  together.col(0).setOnes();
  const std::vector<Eigen::MatrixXd> shapes{kAlike[0], together};
  Case of = MakeCase(0.2, 1, 1);
  EXPECT_EQ(Estimate(of, shapes).shape, 0);
  of.residual += of.by * (of.truth.array() - 0.2).matrix();  // now all are 0.2
  const AmplitudeEstimate estimate = Estimate(of, shapes);
  EXPECT_EQ(estimate.shape, 1);
  EXPECT_NEAR(estimate.mean.mean(), 0.2, 4 / std::sqrt(kRows * kAmplitudes));  // 4 deviations
}

}  // namespace
}  // namespace lacuna
