#include "registration/posterior.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "registration/warped_body.h"

namespace lacuna {
namespace {

constexpr double kSigma = 0.006;
constexpr double kOutliers = 0.2;
constexpr double kVolume = 1e-3;

TEST(PosteriorTest, FollowsBayesRuleForTheTruncatedMixture) {
  const Eigen::Matrix3Xf source = SampleBody(203, 1).points.cast<float>();
  const Eigen::Matrix3Xf target = SampleBody(150, 2).points.cast<float>();
  const BlockTree source_tree(source);
  BlockTree target_tree(target);
  const Mixture mixture = {kSigma, kOutliers, kVolume, 4.0};
  const Posterior posterior = ComputePosterior(source_tree, mixture, BestKernels(), &target_tree);

  Eigen::MatrixXd p(203, 150);
  for (int m = 0; m < 203; ++m) {
    for (int n = 0; n < 150; ++n) {
      const double distance = (source.col(m) - target.col(n)).cast<double>().norm() / kSigma;
      p(m, n) = distance <= 4.0 ? std::exp(-0.5 * distance * distance) /
                                      std::pow(2.0 * std::numbers::pi * kSigma * kSigma, 1.5) *
                                      (1.0 - kOutliers) / 203
                                : 0.0;
    }
  }
  const Eigen::RowVectorXd density = p.colwise().sum().array() + kOutliers / kVolume;
  p = p.array().rowwise() / density.array();
  // Single precision, and 2^t with an error of 3e-6.
  EXPECT_LT((posterior.weight.cast<double>() - p.rowwise().sum()).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_LT((posterior.inlier.cast<double>().transpose() - p.colwise().sum()).cwiseAbs().maxCoeff(),
            1e-5);
  EXPECT_NEAR(posterior.total_weight, p.sum(), 1e-5 * p.sum());
  double spread = 0.0;
  for (int m = 0; m < 203; ++m) {
    Eigen::Vector3d shift = Eigen::Vector3d::Zero();
    for (int n = 0; n < 150; ++n) {
      const Eigen::Vector3d d = (target.col(n) - source.col(m)).cast<double>();
      shift += p(m, n) * d;
      spread += p(m, n) * d.squaredNorm();
    }
    const double weight = p.row(m).sum();
    if (weight > 0.0) {
      EXPECT_LT((posterior.shift.col(m).cast<double>() - shift / weight).norm(), 1e-4 * kSigma);
    }
  }
  EXPECT_NEAR(posterior.total_spread, spread, 1e-5 * spread);
}

TEST(PosteriorTest, IsZeroAndNotNanWithoutAnyNeighbour) {
  const BlockTree source(SampleBody(20, 1).points.cast<float>());
  BlockTree target((SampleBody(20, 2).points.array() + 5.0).matrix().cast<float>());
  for (const double outliers : {0.0, 0.1}) {
    const Posterior posterior =
        ComputePosterior(source, {kSigma, outliers, kVolume, 4.0}, BestKernels(), &target);
    EXPECT_EQ(posterior.total_weight, 0.0);
    EXPECT_TRUE(posterior.shift.isZero());
    EXPECT_TRUE(posterior.inlier.isZero());
  }
}

}  // namespace
}  // namespace lacuna
