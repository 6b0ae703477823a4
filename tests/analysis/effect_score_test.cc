#include "analysis/effect_score.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <random>

namespace lacuna {
namespace {

constexpr int kRows = 200;

Eigen::MatrixXd Random(int rows, int columns, std::mt19937* random) {
  std::normal_distribution<double> normal;
  return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(*random); });
}

TEST(EffectScore, IsTheEvidenceOfTheLinearModel) {
  // ln N(r; 0, C + S Λ Sᵀ) − ln N(r; 0, C), from dense matrices.
  std::mt19937 random(3);
  const Eigen::MatrixXd J = Random(kRows, 3, &random), S = Random(kRows, 2, &random);
  const Eigen::VectorXd r = Random(kRows, 1, &random);
  const Eigen::Vector3d prior(0.5, 2, 1);
  const Eigen::Vector2d scale(0.3, 0.1);
  const FittedModel fitted(r, J, prior);
  const EffectScore score = ScoreEffect(fitted, S, scale, {false, false});
  const Eigen::MatrixXd C =
      Eigen::MatrixXd::Identity(kRows, kRows) + J * prior.cwiseAbs2().asDiagonal() * J.transpose();
  const Eigen::MatrixXd more = C + S * scale.cwiseAbs2().asDiagonal() * S.transpose();
  const auto log_density = [&](const Eigen::MatrixXd& covariance) {
    const Eigen::LDLT<Eigen::MatrixXd> factor(covariance);
    return -0.5 * r.dot(factor.solve(r)) - 0.5 * factor.vectorD().array().log().sum();
  };
  // The residual's own variance is below 1, so that the noise counts as 1.
  ASSERT_LT(fitted.Product(r, r)(0, 0), kRows);
  EXPECT_NEAR(score.evidence, log_density(more) - log_density(C), 1e-8);
}

TEST(EffectScore, FindsTheSizeOfAPlantedEffect) {
  std::mt19937 random(5);
  const Eigen::MatrixXd J = Random(kRows, 2, &random), S = Random(kRows, 1, &random);
  const double planted = 3;
  const Eigen::VectorXd r = Random(kRows, 1, &random) - planted * S;
  const FittedModel fitted(r, J, Eigen::Vector2d::Constant(INFINITY));
  const EffectScore score = ScoreEffect(fitted, S, Eigen::VectorXd::Constant(1, 10), {true});
  // One standard deviation is 1/√200 = 0.07.
  EXPECT_NEAR(score.size[0], planted, 0.3);
  EXPECT_NEAR(score.deviation[0], 1 / std::sqrt(kRows), 0.02);
  EXPECT_GT(score.evidence, 100);
  EXPECT_GT(score.explained, 0.8);
  EXPECT_NEAR(score.detectable[0], 4 / std::sqrt(kRows), 0.05);

  const EffectScore wrong_way = ScoreEffect(FittedModel(-r, J, Eigen::Vector2d::Constant(INFINITY)),
                                            S, Eigen::VectorXd::Constant(1, 10), {true});
  EXPECT_EQ(wrong_way.size[0], 0);
  EXPECT_LT(wrong_way.evidence, 0);
}

TEST(EffectScore, SeesNothingOfWhatTheFittedParametersCanDo) {
  std::mt19937 random(7);
  const Eigen::MatrixXd J = Random(kRows, 3, &random);
  const Eigen::VectorXd r = Random(kRows, 1, &random);
  const FittedModel fitted(r, J, Eigen::Vector3d::Constant(INFINITY));
  const EffectScore score = ScoreEffect(fitted, J * Eigen::Vector3d(1, -2, 0.5),
                                        Eigen::VectorXd::Constant(1, 1), {false});
  EXPECT_NEAR(score.absorbed, 1, 1e-10);
  EXPECT_TRUE(std::isinf(score.detectable[0]));
  EXPECT_NEAR(score.evidence, 0, 1e-6);
}

TEST(EffectScore, IsRarelyLargeWithoutAnEffect) {
  // ln B > 3 calls for bᵀH⁻¹b > 6 + ln(1 + 100·200): once in some 10 000 draws of χ² with one
  // degree of freedom; 500 draws hold none or, with probability 5 %, one.
  std::mt19937 random(11);
  int alarms = 0;
  for (int trial = 0; trial < 500; ++trial) {
    const Eigen::MatrixXd J = Random(kRows, 2, &random), S = Random(kRows, 1, &random);
    const FittedModel fitted(Random(kRows, 1, &random), J, Eigen::Vector2d::Constant(INFINITY));
    alarms += ScoreEffect(fitted, S, Eigen::VectorXd::Constant(1, 10), {false}).evidence > 3;
  }
  EXPECT_LE(alarms, 1);
}

TEST(Collinearity, IsTheCosineOfWhatIsLeftOfTwoDerivatives) {
  std::mt19937 random(13);
  const Eigen::MatrixXd J = Random(kRows, 2, &random);
  const Eigen::MatrixXd basis = Random(kRows, 4, &random).householderQr().householderQ() *
                                Eigen::MatrixXd::Identity(kRows, 4);
  const FittedModel fitted(Eigen::VectorXd::Zero(kRows), basis.leftCols(2),
                           Eigen::Vector2d::Constant(INFINITY));
  const Eigen::VectorXd a = basis.col(2) + 5 * basis.col(0);
  const Eigen::VectorXd b = 3 * basis.col(2) + 4 * basis.col(3) - basis.col(1);
  EXPECT_NEAR(Collinearity(fitted, a, b), 0.6, 1e-6);
  EXPECT_NEAR(Collinearity(fitted, a, a), 1, 1e-6);
  EXPECT_EQ(Collinearity(fitted, a, basis.col(0)), 0);
}

}  // namespace
}  // namespace lacuna
