#include "prediction/smooth_force.h"

#include <gtest/gtest.h>

#include <cmath>

namespace lacuna {
namespace {

TEST(SmoothForce, HatFunctionsAreTheDerivativeOfTheAmplitudes) {
  SmoothForce force;
  force.start = 1;
  force.spacing = 0.5;
  force.amplitudes = Eigen::MatrixXd::Random(SmoothForce::kShapes, 4);
  // Before the start, at a knot, between two knots, and after the last one.
  for (const double time : {0.0, 1.5, 1.8, 9.0}) {
    const Eigen::VectorXd by_hats = force.HatFunctions(time) * force.amplitudes.reshaped();
    EXPECT_LT((by_hats - force.AmplitudesAt(time)).norm(), 1e-15) << time;  // rounding
  }
}

TEST(SmoothForce, APersistentPriorCorrelatesEachShapeOverTheKnots) {
  constexpr int kKnots = 3, kShapes = SmoothForce::kShapes;
  constexpr double kPersistence = 2, kDeviationOfMode = 0.1;
  const Eigen::MatrixXd root = PersistentPriorRoot(kKnots, kPersistence, kDeviationOfMode);
  const Eigen::MatrixXd covariance = root * root.transpose();
  for (int i = 0; i < kKnots; ++i)
    for (int j = 0; j < kKnots; ++j)
      for (int a = 0; a < kShapes; ++a)
        for (int b = 0; b < kShapes; ++b) {
          const double deviation = a < 3 ? 1 : kDeviationOfMode;
          const double expected =
              a == b ? deviation * deviation * std::exp(-std::abs(i - j) / kPersistence) : 0;
          EXPECT_NEAR(covariance(kShapes * i + a, kShapes * j + b), expected, 1e-15);  // rounding
        }
}

}  // namespace
}  // namespace lacuna
