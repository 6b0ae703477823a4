#include "analysis/positive_normal.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "analysis/linear_evidence.h"
#include "analysis/normal_distribution.h"

namespace lacuna {
namespace {

Eigen::Matrix2d Covariance(double first, double second, double correlation) {
  Eigen::Matrix2d covariance;
  covariance << first * first, correlation * first * second, correlation * first * second,
      second * second;
  return covariance;
}

// Draws from N(mean, covariance), of which those with only positive amounts are kept.
struct Rejection {
  Rejection(const Eigen::VectorXd& mean, const Eigen::MatrixXd& covariance, int draws) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    const Eigen::MatrixXd root = covariance.llt().matrixL();
    const Eigen::Index size = mean.size();
    sum = Eigen::VectorXd::Zero(size);
    products = Eigen::MatrixXd::Zero(size, size);
    Eigen::VectorXd x(size);
    for (int k = 0; k < draws; ++k) {
      x = mean + root * Eigen::VectorXd::NullaryExpr(size, [&] { return normal(random); });
      if ((x.array() <= 0).any()) continue;
      ++kept;
      sum += x;
      products += x * x.transpose();
    }
    share = static_cast<double>(kept) / draws;
  }
  Eigen::VectorXd Mean() const { return sum / kept; }
  Eigen::MatrixXd Spread() const { return products / kept - Mean() * Mean().transpose(); }

  int kept = 0;
  double share = 0;
  Eigen::VectorXd sum;
  Eigen::MatrixXd products;
};

// The mean and the covariance matrix of DrawPositive() are those of the draws that are kept. The
// tolerances are about five standard errors of both.
void ExpectDrawsLike(const Rejection& expected, const Eigen::VectorXd& mean,
                     const Eigen::MatrixXd& covariance, int draws) {
  const Eigen::Index size = mean.size();
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(size);
  Eigen::MatrixXd products = Eigen::MatrixXd::Zero(size, size);
  for (int k = 0; k < draws; ++k) {
    const Eigen::VectorXd x = DrawPositive(mean, covariance, static_cast<uint64_t>(k));
    ASSERT_GE(x.minCoeff(), 0);
    sum += x;
    products += x * x.transpose();
  }
  sum /= draws;
  const Eigen::MatrixXd spread = products / draws - sum * sum.transpose();
  const double error = 5 * std::sqrt(1.0 / draws + 1.0 / expected.kept);
  const Eigen::VectorXd deviation = expected.Spread().diagonal().cwiseSqrt();
  for (Eigen::Index k = 0; k < size; ++k) {
    EXPECT_NEAR(sum[k], expected.Mean()[k], error * deviation[k]) << k;
    for (Eigen::Index j = 0; j < size; ++j)
      EXPECT_NEAR(spread(k, j), expected.Spread()(k, j), 2 * error * deviation[k] * deviation[j])
          << k << " " << j;
  }
}

TEST(LogOrthantFactor, IsThatOfOneTruncatedPrior) {
  for (const double z : {-40.0, -2.0, 0.3})
    EXPECT_EQ(
        LogOrthantFactor(Eigen::VectorXd::Constant(1, 2 * z), Eigen::MatrixXd::Constant(1, 1, 4)),
        LogTwiceNormal(z));
  EXPECT_EQ(LogOrthantFactor({}, {}), 0);
}

// Two amounts with unit deviations. ln 4P was made in Python with the module decimal and 50 digits,
// from the integral in positive_normal.h by the tanh-sinh rule on both sides of its largest value,
// with the Φ of normal_distribution_test.cc. Where the rounding allows it, the same digits follow
// from P = Φ(a) Φ(b) + 1/2π ∫ from 0 to ρ of exp(−(a² − 2abt + b²)/(2 (1 − t²)))/√(1 − t²) dt
// (R. L. Plackett, Biometrika 41, 1954).
TEST(LogOrthantFactor, IsAccurateForTwoAmountsFromTailToTail) {
  struct Pair {
    double a, b, correlation, factor;
  };
  constexpr Pair kPairs[] = {{0.5, -0.25, 0, 0.104286181020099171},
                             {0.5, -0.25, -0.5, -0.199950421149190786},
                             {0.5, -0.25, 1 - 0x1p-30, 0.473232596308755564},
                             {2, 1.5, 0.875, 1.31345542405606723},
                             {8, 9, 0, 1.38629436111989},
                             {-3, -4, 0.9375, -8.97959659263613846},
                             {-3, -4, -0.9375, -203.583369057519249},
                             {-25, 3, 0.25, -315.253113646900368},
                             {-25, -24.5, 0x1p-30 - 1, -657733976102.43868},
                             {-40, -45, -0.5, -3625.85978787807926},
                             {-40, -45, 0.5, -1223.63362772769835},
                             {38, -38.5, -0.9375, -744.308975964387936},
                             {-1000, -900, 0.25, -725347.011562527105}};
  for (const Pair& pair : kPairs)
    EXPECT_NEAR(
        LogOrthantFactor(Eigen::Vector2d(pair.a, pair.b), Covariance(1, 1, pair.correlation)),
        pair.factor, 1e-12 * std::max(1.0, std::abs(pair.factor)))
        << pair.a << " " << pair.b << " " << pair.correlation;
}

// P = 1/4 + arcsin ρ / 2π for two amounts with the mean 0 (Sheppard 1899). It vanishes with
// arccos(−ρ), which keeps its digits.
TEST(LogOrthantFactor, IsThatOfTwoCentredAmounts) {
  for (const double correlation : {-0.9999, -0.9, -0.3, 0.0, 0.5, 0.99, 0.999999})
    EXPECT_NEAR(LogOrthantFactor(Eigen::Vector2d::Zero(), Covariance(3, 0.1, correlation)),
                std::log(2 / std::numbers::pi * std::acos(-correlation)), 1e-11)
        << correlation;
}

// The second amount is positive or negative: both probabilities sum to that of the first one.
TEST(LogOrthantFactor, SumsToTheMarginalProbability) {
  for (const double correlation : {-0.99999, -0.7, 0.2, 0.999})
    for (const double first : {-25.0, -3.0, 0.5, 40.0})
      for (const double second : {-4.0, 0.0, 1.5}) {
        const auto factor = [&](double sign) {
          return LogOrthantFactor(Eigen::Vector2d(2 * first, sign * second),
                                  Covariance(2, 1, sign * correlation));
        };
        EXPECT_NEAR(LogMeanExp({factor(1), factor(-1)}), LogTwiceNormal(first), 1e-11)
            << correlation << " " << first << " " << second;
      }
}

TEST(LogOrthantFactor, IsTheSumOfIndependentAmountsInTheTails) {
  for (const double second : {-28.0, -1.0, 9.0})
    EXPECT_NEAR(LogOrthantFactor(Eigen::Vector2d(-22, second), Covariance(1, 1, 0)),
                LogTwiceNormal(-22) + LogTwiceNormal(second), 1e-11);
  const Eigen::Vector3d three(-25, 0.5, -2);
  EXPECT_NEAR(LogOrthantFactor(three, Eigen::Matrix3d::Identity()),
              LogTwiceNormal(-25) + LogTwiceNormal(0.5) + LogTwiceNormal(-2), 1e-11);
}

TEST(LogOrthantFactor, IsTheShareOfPositiveDraws) {
  const Eigen::Vector2d mean(1, -0.5);
  for (const double correlation : {-0.8, 0.6}) {
    const Eigen::Matrix2d covariance = Covariance(2, 1, correlation);
    const Rejection drawn(mean, covariance, 200000);
    EXPECT_NEAR(LogOrthantFactor(mean, covariance), std::log(4 * drawn.share),
                4 / std::sqrt(drawn.kept))
        << correlation;
  }
}

// The approximation for three amounts. The product of their marginal probabilities is off by
// twenty times the tolerance, and the approximation without the change of the variance by nine
// times.
TEST(LogOrthantFactor, IsNearTheShareOfPositiveDrawsOfThree) {
  Eigen::Matrix3d root;
  root << 1, 0.3, -0.5, 0.9, -0.2, 0.3, -0.4, 0.5, 1;
  const Eigen::Matrix3d covariance = root * root.transpose();
  const Eigen::Vector3d mean(-1, -0.5, 1);
  const Rejection drawn(mean, covariance, 400000);
  EXPECT_NEAR(LogOrthantFactor(mean, covariance), std::log(8 * drawn.share), 0.02);
}

TEST(DrawPositive, DrawsOneTruncatedAmount) {
  for (const double mean : {-2.0, 0.5}) {
    const Eigen::VectorXd m = Eigen::VectorXd::Constant(1, mean);
    const Eigen::MatrixXd c = Eigen::MatrixXd::Constant(1, 1, 1.44);
    ExpectDrawsLike(Rejection(m, c, 400000), m, c, 20000);
  }
}

// Two alike amounts, of which the recordings know the sum, 1 ± 0.1, and hardly the difference,
// 0 ± 3. If each were truncated by itself, one after the other, the sum would be about 1.6 ± 0.8.
TEST(DrawPositive, DrawsTwoAlikeAmounts) {
  const Eigen::Vector2d mean(0.5, 0.5);
  const double square = 0.25 * (0.01 + 9), product = 0.25 * (0.01 - 9);
  Eigen::Matrix2d covariance;
  covariance << square, product, product, square;
  const Rejection expected(mean, covariance, 400000);
  const Eigen::Vector2d one(1, 1);
  EXPECT_NEAR(expected.Mean().sum(), 1.01, 0.01);
  EXPECT_NEAR(std::sqrt(one.dot(expected.Spread() * one)), 0.1, 0.01);
  ExpectDrawsLike(expected, mean, covariance, 10000);
  constexpr int kDraws = 2000;
  double sum = 0, squares = 0;
  for (int k = 0; k < kDraws; ++k) {
    const double both = DrawPositive(mean, covariance, static_cast<uint64_t>(k)).sum();
    sum += both / kDraws;
    squares += both * both / kDraws;
  }
  EXPECT_NEAR(sum, expected.Mean().sum(), 0.01);
  EXPECT_NEAR(std::sqrt(squares - sum * sum), 0.1, 0.01);
}

TEST(DrawPositive, DrawsTwoAmountsThatAreHardlyPositive) {
  for (const double correlation : {-0.6, 0.95}) {
    const Eigen::Vector2d mean(-1, -0.8);
    const Eigen::Matrix2d covariance = Covariance(1, 2, correlation);
    ExpectDrawsLike(Rejection(mean, covariance, 400000), mean, covariance, 10000);
  }
}

TEST(DrawPositive, DrawsThreeAmounts) {
  Eigen::Matrix3d root;
  root << 1, 0.3, -0.5, 0.9, -0.2, 0.3, -0.4, 0.5, 1;
  const Eigen::Vector3d mean(-0.5, 0.3, -0.4);
  const Eigen::Matrix3d covariance = root * root.transpose();
  ExpectDrawsLike(Rejection(mean, covariance, 400000), mean, covariance, 400);
}

// (x − m)ᵀ C⁻¹ (x − m), the least of which is at the mode.
double Distance(const Eigen::VectorXd& x, const Eigen::VectorXd& mean,
                const Eigen::MatrixXd& covariance) {
  return (x - mean).dot(covariance.llt().solve(x - mean));
}

TEST(PositiveMode, IsTheMeanWhereThatIsAllowed) {
  const Eigen::Vector2d mean(-1, 2);
  EXPECT_EQ(PositiveMode(mean, Covariance(1, 2, 0.5), {1}), mean);
  EXPECT_EQ(PositiveMode(mean, Covariance(1, 2, 0.5), {}), mean);
}

TEST(PositiveMode, MovesTheOthersBesideAnAmountOfZero) {
  const Eigen::Vector2d mode = PositiveMode(Eigen::Vector2d(-1, 2), Covariance(1, 2, 0.5), {0});
  EXPECT_EQ(mode[0], 0);
  EXPECT_NEAR(mode[1], 2 + 0.5 * 2 * 1, 1e-12);
}

// Both means are negative. In the first case both amounts are 0 at the mode, which is not where one
// after another is set to 0; in the second the first amount is positive, beside 0 of the second.
TEST(PositiveMode, IsFoundWhereBothArePushedBelowZero) {
  EXPECT_EQ(PositiveMode(Eigen::Vector2d(-1, -1), Covariance(1, 1, 0.9), {0, 1}),
            Eigen::Vector2d(0, 0));
  const Eigen::Vector2d mode =
      PositiveMode(Eigen::Vector2d(-0.1, -1), Covariance(1, 1, 0.99), {0, 1});
  EXPECT_NEAR(mode[0], 0.89, 1e-12);
  EXPECT_EQ(mode[1], 0);
}

// More amounts than whose subsets could be tried: the gradient H (x − m) of the mode x, with the
// inverse H of the covariance, is 0 for positive amounts and not negative for those at 0.
TEST(PositiveMode, IsFoundAmongManyAmounts) {
  constexpr Eigen::Index kAmounts = 60;
  std::mt19937_64 random(10);
  std::normal_distribution<double> normal;
  const auto draw = [&](Eigen::Index rows, Eigen::Index columns) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  };
  const Eigen::MatrixXd root = draw(kAmounts, kAmounts);
  const Eigen::MatrixXd covariance =
      root * root.transpose() / kAmounts + 0.1 * Eigen::MatrixXd::Identity(kAmounts, kAmounts);
  const Eigen::VectorXd mean = draw(kAmounts, 1);
  std::vector<Eigen::Index> positive;
  for (Eigen::Index k = 0; k < kAmounts; ++k) positive.push_back(k);
  const Eigen::VectorXd mode = PositiveMode(mean, covariance, positive);
  const Eigen::VectorXd gradient = covariance.llt().solve(mode - mean);
  int of_negative_mean = 0;
  for (const Eigen::Index k : positive) {
    EXPECT_GE(mode[k], 0) << k;
    if (mode[k] > 0)
      EXPECT_NEAR(gradient[k], 0, 1e-10) << k;
    else
      EXPECT_GE(gradient[k], -1e-10) << k;
    of_negative_mean += mean[k] < 0 && mode[k] > 0 ? 1 : 0;
  }
  EXPECT_GT(of_negative_mean, 0) << "a mode that is not found by setting negative means to 0";
}

// No allowed point near it, nor far from it, has a larger density.
TEST(PositiveMode, HasTheLargestAllowedDensity) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> normal;
  const auto draw = [&](Eigen::Index rows, Eigen::Index columns) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return normal(random); });
  };
  int at_zero = 0;
  for (int trial = 0; trial < 50; ++trial) {
    const Eigen::MatrixXd root = draw(4, 4);
    const Eigen::MatrixXd covariance =
        root * root.transpose() + 1e-2 * Eigen::MatrixXd::Identity(4, 4);
    const Eigen::VectorXd mean = draw(4, 1);
    const Eigen::VectorXd mode = PositiveMode(mean, covariance, {0, 1, 3});
    EXPECT_GE(std::min({mode[0], mode[1], mode[3]}), 0);
    at_zero += static_cast<int>((mode.array() == 0).count());
    const double least = Distance(mode, mean, covariance);
    for (int k = 0; k < 300; ++k) {
      Eigen::VectorXd other = mode + std::pow(10, -(k % 4)) * draw(4, 1);
      for (const int positive : {0, 1, 3}) other[positive] = std::max(0.0, other[positive]);
      EXPECT_GE(Distance(other, mean, covariance), least * (1 - 1e-9)) << trial;
    }
  }
  EXPECT_GT(at_zero, 20);
}

}  // namespace
}  // namespace lacuna
