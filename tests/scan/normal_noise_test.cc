#include "scan/normal_noise.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lacuna {
namespace {

TEST(NormalNoise, OfAnEntryDependsOnItsSourceAndPlaceAlone) {
  Eigen::Matrix3Xd values = Eigen::Matrix3Xd::Constant(3, 2, 5);
  AddNormalNoise(0.1, {.seed = 7, .stream = 80, .number = 2}, values);
  for (int k = 0; k < 6; ++k)
    EXPECT_DOUBLE_EQ(values(k % 3, k / 3),
                     5 + 0.1 * Normal(RandomBits({7, 80, 2, static_cast<uint64_t>(k)})))
        << k;
  Eigen::MatrixXd other = Eigen::MatrixXd::Constant(3, 2, 5);
  AddNormalNoise(0.1, {.seed = 7, .stream = 81, .number = 2}, other);
  EXPECT_GT((values - other).cwiseAbs().minCoeff(), 0);
}

TEST(NormalNoise, HasTheDeviation) {
  Eigen::MatrixXd values = Eigen::MatrixXd::Zero(100, 100);
  AddNormalNoise(2, {.seed = 1}, values);
  // The standard errors of 10 000 draws, times four.
  EXPECT_NEAR(values.mean(), 0, 4 * 0.02);
  EXPECT_NEAR(values.norm() / 100, 2, 4 * 2 / std::sqrt(2e4));
}

}  // namespace
}  // namespace lacuna
