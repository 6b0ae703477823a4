#include "diagnosis/decision_maker.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <numbers>

namespace lacuna {
namespace {

TEST(NaturalValue, IsBelievedWhereItIsMet) {
  const Eigen::Vector3d narrow = Eigen::Vector3d::Constant(0.3);
  const double met = NaturalValueEvidence({-2.7, 0.2, -9.4}, narrow, 9.8, 9.80665);
  EXPECT_GT(met, 1.5);
  const double missed = NaturalValueEvidence({-2.7, 0.2, -5}, narrow, 9.8, 9.80665);
  EXPECT_NEAR(missed, std::log(0.5), 0.01);
  EXPECT_EQ(NaturalValueEvidence({-2.7, 0.2, -9.4}, {5, 5, 5}, 9.8, 9.80665), 0);
  // Against the integral over the sphere by brute force.
  const Eigen::Vector3d mean(0, 0, 9.6), deviation(0.2, 0.2, 0.3);
  const auto density = [](const Eigen::Vector3d& x, const Eigen::Vector3d& m,
                          const Eigen::Vector3d& s) {
    return std::exp(-0.5 * (x - m).cwiseQuotient(s).squaredNorm()) /
           (s.prod() * std::pow(2 * std::numbers::pi, 1.5));
  };
  double sum = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double z = 1 - 0.01 * (i + 0.5) / kSteps;  // the posterior is narrow about the pole
    for (int j = 0; j < 16; ++j) {
      const double angle = 2 * std::numbers::pi * j / 16, r = std::sqrt(1 - z * z);
      sum += density(9.80665 * Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z), mean,
                     deviation) *
             0.01 / 2 / kSteps / 16;
    }
  }
  const double factor = sum / density({0, 0, 9.80665}, {0, 0, 0}, Eigen::Vector3d::Constant(9.8));
  EXPECT_NEAR(NaturalValueEvidence(mean, deviation, 9.8, 9.80665), std::log(0.5 + 0.5 * factor),
              0.1);
}

}  // namespace
}  // namespace lacuna
