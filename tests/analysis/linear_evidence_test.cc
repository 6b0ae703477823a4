#include "analysis/linear_evidence.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>

namespace lacuna {
namespace {

constexpr int kRows = 200;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

Eigen::MatrixXd Random(int rows, int columns, std::mt19937* random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(*random); });
}

TEST(LinearGaussianModel, HasTheEvidenceOfItsGaussian) {
  // ln N(r; −A m, v I + A P Aᵀ) minus that without parameters, from dense matrices.
  std::mt19937 random(3);
  const Eigen::MatrixXd A = Random(kRows, 3, &random);
  const Eigen::VectorXd r = Random(kRows, 1, &random);
  const double variance = 1.7;
  const Eigen::Vector3d mean(0.2, -0.5, 0), deviation(0.5, 2, 0.1);
  std::vector<LinearPrior> priors;
  for (int k = 0; k < 3; ++k) priors.push_back({mean[k], deviation[k], false});
  const LinearGaussianModel model(r, A, priors);
  const auto log_density = [&](const Eigen::VectorXd& x, const Eigen::MatrixXd& covariance) {
    const Eigen::LDLT<Eigen::MatrixXd> factor(covariance);
    return -0.5 * x.dot(factor.solve(x)) - 0.5 * factor.vectorD().array().log().sum();
  };
  const Eigen::MatrixXd noise = variance * Eigen::MatrixXd::Identity(kRows, kRows);
  const Eigen::MatrixXd with = noise + A * deviation.cwiseAbs2().asDiagonal() * A.transpose();
  // Rounding of a 200 × 200 determinant.
  EXPECT_NEAR(model.Fit({0, 1, 2}, variance).log_evidence - model.Fit({}, variance).log_evidence,
              log_density(r + A * mean, with) - log_density(r, noise), 1e-8);
}

TEST(LinearGaussianModel, HasTheEvidenceOfATruncatedPrior) {
  // ∫ over θ > 0 of 2 N(θ; 0, s²) exp(−½ ‖r + a θ‖²) by the trapezoidal rule.
  std::mt19937 random(4);
  const Eigen::MatrixXd a = Random(kRows, 1, &random);
  for (const double planted : {-0.3, 0.0, 0.3}) {
    const Eigen::VectorXd r = Random(kRows, 1, &random) - planted * a;
    const double s = 0.5, h = 1e-4;
    const LinearGaussianModel model(r, a, {{0, s, true}});
    double sum = 0;
    for (int i = 0; i < 50000; ++i) {
      const double theta = i * h;
      sum += (i == 0 ? 0.5 : 1) * h * 2 / (s * std::sqrt(2 * std::numbers::pi)) *
             std::exp(-0.5 * theta * theta / (s * s) -
                      0.5 * ((r + theta * a).squaredNorm() - r.squaredNorm()));
    }
    const LinearFit fit = model.Fit({0}, 1);
    EXPECT_NEAR(fit.log_evidence - model.Fit({}, 1).log_evidence, std::log(sum), 1e-3) << planted;
    EXPECT_GE(fit.change[0], 0);
  }
}

TEST(LinearGaussianModel, RecoversTheTruth) {
  std::mt19937 random(5);
  const Eigen::MatrixXd A = Random(kRows, 3, &random);
  const Eigen::VectorXd r = Random(kRows, 1, &random) - 3 * A.col(2);
  const LinearGaussianModel model(r, A, {{0, kInfinity}, {0, kInfinity}, {0, 10, true}});
  const LinearFit fit = model.Fit({0, 1, 2}, 1);
  // One standard deviation is 1/√200 = 0.07.
  EXPECT_NEAR(fit.change[2], 3, 0.3);
  EXPECT_NEAR(fit.deviation[2], 1 / std::sqrt(kRows), 0.02);
  EXPECT_NEAR(fit.misfit, (r + A * fit.change).squaredNorm(), 1e-9);
  EXPECT_GT(fit.log_evidence - model.Fit({0, 1}, 1).log_evidence, 100);
}

// The changes that minimise ‖r + A δ‖² + Σ (δ/s)² with the changes of `held` at 0, from a QR
// factorisation of the other columns, below which their priors stand as further rows.
Eigen::VectorXd LeastSquares(const Eigen::VectorXd& r, const Eigen::MatrixXd& A, double s,
                             unsigned held) {
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < A.cols(); ++k)
    if ((held >> k & 1) == 0) free.push_back(k);
  const Eigen::Index count = static_cast<Eigen::Index>(free.size());
  Eigen::MatrixXd rows(A.rows() + count, count);
  rows << A(Eigen::all, free), Eigen::MatrixXd::Identity(count, count) / s;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(rows.rows());
  right.head(r.size()) = -r;
  Eigen::VectorXd change = Eigen::VectorXd::Zero(A.cols());
  change(free) = rows.householderQr().solve(right);
  return change;
}

// The quadratic programme is solved by trying every set of columns that could be held at 0. In
// several of the cases, a change that is negative without the restriction is positive with it,
// because another one that was negative is held.
TEST(LinearGaussianModel, FindsTheBestOfTheChangesThatMustBePositive) {
  constexpr int kFree = 1, kPositive = 5;  // columns
  constexpr double kDeviation = 2;
  std::mt19937 random(19);
  std::vector<LinearPrior> priors(kFree + kPositive, {0, kDeviation, true});
  priors[0].positive = false;
  int turned = 0;
  for (int trial = 0; trial < 30; ++trial) {
    // Columns that are alike, or opposite.
    Eigen::MatrixXd A = 0.3 * Random(kRows, kFree + kPositive, &random);
    A += Random(kRows, 1, &random) * Random(1, kFree + kPositive, &random);
    const Eigen::VectorXd r = 3 * Random(kRows, 1, &random);
    const auto cost = [&](const Eigen::VectorXd& change) {
      return (r + A * change).squaredNorm() + change.squaredNorm() / (kDeviation * kDeviation);
    };
    Eigen::VectorXd best;
    for (unsigned held = 0; held < 1u << kPositive; ++held) {
      const Eigen::VectorXd change = LeastSquares(r, A, kDeviation, held << kFree);
      if (change.tail(kPositive).minCoeff() < 0) continue;
      if (best.size() == 0 || cost(change) < cost(best)) best = change;
    }
    const LinearFit fit = LinearGaussianModel(r, A, priors).FitAll(1);
    EXPECT_LT((fit.change - best).norm(), 1e-9) << trial;
    EXPECT_NEAR(fit.misfit, (r + A * best).squaredNorm(), 1e-8) << trial;
    const Eigen::VectorXd unrestricted = LeastSquares(r, A, kDeviation, 0);
    const auto negative = (unrestricted.tail(kPositive).array() < 0);
    turned += (negative && best.tail(kPositive).array() > 0).any() ? 1 : 0;
  }
  EXPECT_GE(turned, 5);
}

TEST(LinearGaussianModel, RemovesColumnsThatAreProjectedOut) {
  std::mt19937 random(7);
  Eigen::MatrixXd A = Random(kRows, 4, &random);
  A.col(3) = A.leftCols(3) * Eigen::Vector3d(1, -2, 0.5);
  const LinearGaussianModel model(Random(kRows, 1, &random), A,
                                  std::vector<LinearPrior>(4, {0, kInfinity}));
  EXPECT_NEAR(model.Remaining({0, 1, 2}, {3}, {3}, 1)(0, 0) / model.Square(3), 0, 1e-10);
  EXPECT_EQ(model.Collinearity({0, 1, 2}, {3}, {3}, 1), 0);
}

TEST(LinearGaussianModel, RarelyFindsStrongEvidenceForAnAbsentEffect) {
  // ln B > 3 requires z² > 6 + ln(1 + 100·200), which has a probability of about 1e-4 for χ² with
  // one degree of freedom; among 500 draws there is one with a probability of 5 %.
  std::mt19937 random(11);
  int alarms = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const LinearGaussianModel model(Random(kRows, 1, &random), Random(kRows, 3, &random),
                                    {{0, kInfinity}, {0, kInfinity}, {0, 10}});
    alarms += model.Fit({0, 1, 2}, 1).log_evidence - model.Fit({0, 1}, 1).log_evidence > 3;
  }
  EXPECT_LE(alarms, 1);
}

TEST(LinearGaussianModel, RecognisesParallelColumns) {
  std::mt19937 random(13);
  Eigen::MatrixXd A = Random(kRows, 4, &random);
  A.col(2) = A.col(1) + 0.01 * Random(kRows, 1, &random) + 5 * A.col(0);
  const LinearGaussianModel model(Random(kRows, 1, &random), A,
                                  std::vector<LinearPrior>(4, {0, 10}));
  // Parallel after the first column has been projected out; unrelated columns correlate by 1/√200.
  EXPECT_GT(model.Collinearity({0}, {1}, {2}, 1), 0.999);
  EXPECT_LT(model.Collinearity({0}, {1}, {3}, 1), 0.4);
}

// Values whose exponentials overflow.
TEST(LogMeanExp, IsTheLogarithmOfTheMean) {
  EXPECT_NEAR(LogMeanExp({1000, 1000 + std::log(3)}), 1000 + std::log(2), 1e-12);
  EXPECT_EQ(LogMeanExp({-2000}), -2000);
}

TEST(AppendColumns, KeepsColumnsAndPriorsInOneOrder) {
  std::mt19937 random(17);
  const Eigen::MatrixXd first = Random(kRows, 2, &random), second = Random(kRows, 1, &random);
  Eigen::MatrixXd columns;
  std::vector<LinearPrior> priors;
  AppendColumns(first, {{0, 1}, {0, 2}}, &columns, &priors);
  AppendColumns({}, {}, &columns, &priors);
  AppendColumns(second, {{0, 3}}, &columns, &priors);
  EXPECT_EQ(columns.leftCols(2), first);
  EXPECT_EQ(columns.rightCols(1), second);
  ASSERT_EQ(priors.size(), 3u);
  for (size_t k = 0; k < 3; ++k) EXPECT_EQ(priors[k].deviation, static_cast<double>(k + 1));
  EXPECT_DEATH(AppendColumns(Random(1, 1, &random), {{0, 1}}, &columns, &priors), "rows");
}

}  // namespace
}  // namespace lacuna
