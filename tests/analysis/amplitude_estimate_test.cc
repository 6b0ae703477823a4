#include "analysis/amplitude_estimate.h"

#include <gtest/gtest.h>

#include <random>

namespace lacuna {
namespace {

constexpr int kRows = 400, kAmplitudes = 10;

struct Case {
  Eigen::MatrixXd jacobian;
  Eigen::VectorXd truth, residual;
};

// Random amplitudes of standard deviation `width`, observed with noise of standard deviation
// `noise`.
Case MakeCase(double width, double noise, int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const auto draw = [&](Eigen::Index rows, Eigen::Index columns) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  };
  Case made;
  made.jacobian = draw(kRows, kAmplitudes);
  made.truth = width * draw(kAmplitudes, 1);
  made.residual = noise * draw(kRows, 1) - made.jacobian * made.truth;
  return made;
}

const std::vector<Eigen::MatrixXd> kAlike{Eigen::MatrixXd::Identity(kAmplitudes, kAmplitudes)};

AmplitudeEstimate Estimate(const Case& of, const std::vector<Eigen::MatrixXd>& shapes = kAlike) {
  return EstimateAmplitudes(FittedModel(of.residual, Eigen::MatrixXd(kRows, 0), Eigen::VectorXd()),
                            of.jacobian, kRows, 1, shapes);
}

TEST(AmplitudeEstimate, CoversTheTruthAtTheNominalRate) {
  int inside = 0;
  constexpr int kCases = 50;
  for (int seed = 0; seed < kCases; ++seed) {
    const Case of = MakeCase(0.5, 2, seed);
    const AmplitudeEstimate estimate = Estimate(of);
    EXPECT_NEAR(estimate.noise, 2, 0.3);  // 4 standard deviations for 400 rows
    for (int k = 0; k < kAmplitudes; ++k)
      inside +=
          std::abs(estimate.mean[k] - of.truth[k]) < 1.96 * std::sqrt(estimate.covariance(k, k));
  }
  // 95 % of 500, ± 3 binomial standard deviations.
  EXPECT_NEAR(inside, 475, 15);
}

TEST(AmplitudeEstimate, HasLittleEvidenceIfThereAreNoAmplitudes) {
  for (int seed = 0; seed < 20; ++seed) {
    const Case of = MakeCase(0, 1, seed);
    const AmplitudeEstimate estimate = Estimate(of);
    EXPECT_LT(estimate.evidence, 4);  // exceeded in about one case in fifty
    // The deviations are still realistic: the data determine each amplitude to 1/√400.
    EXPECT_GT(std::sqrt(estimate.covariance(0, 0)), 0.2 / std::sqrt(kRows));
    for (int k = 0; k < kAmplitudes; ++k)
      EXPECT_LT(std::abs(estimate.mean[k]), 4 * std::sqrt(estimate.covariance(k, k)));
  }
}

TEST(AmplitudeEstimate, ChoosesTheShapeOfPriorThatFitsTheData) {
  // Equal amplitudes, or independent ones.
  Eigen::MatrixXd together = 0.01 * Eigen::MatrixXd::Identity(kAmplitudes, kAmplitudes);
  together.col(0).setOnes();
  const std::vector<Eigen::MatrixXd> shapes{kAlike[0], together};
  Case of = MakeCase(0.2, 1, 1);
  EXPECT_EQ(Estimate(of, shapes).shape, 0);
  of.residual += of.jacobian * (of.truth.array() - 0.2).matrix();  // now all amplitudes are 0.2
  const AmplitudeEstimate estimate = Estimate(of, shapes);
  EXPECT_EQ(estimate.shape, 1);
  EXPECT_NEAR(estimate.mean.mean(), 0.2,
              4 / std::sqrt(kRows * kAmplitudes));  // 4 standard deviations
}

}  // namespace
}  // namespace lacuna
