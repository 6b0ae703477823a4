#include "analysis/non_negative_minimum.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <functional>
#include <vector>

namespace lacuna {
namespace {

// ½ xᵀ H x − bᵀ x, with a count of how often it was minimised.
struct QuadraticFunction {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  int calls = 0;

  MinimumWithZeros operator()(const std::vector<Eigen::Index>& zeros) {
    ++calls;
    std::vector<Eigen::Index> free;
    for (Eigen::Index k = 0; k < b.size(); ++k)
      if (std::count(zeros.begin(), zeros.end(), k) == 0) free.push_back(k);
    const Eigen::VectorXd of_free = Eigen::MatrixXd(H(free, free)).inverse() * b(free);
    Eigen::VectorXd x = Eigen::VectorXd::Zero(b.size());
    x(free) = of_free;
    return {x, (H * x - b)(zeros), 0.5 * x.dot(H * x) - b.dot(x)};
  }
};

// H of two alike arguments and a third one.
Eigen::Matrix3d AlikeArguments() { return Eigen::Matrix3d{{1, 0.9, 0}, {0.9, 1, 0}, {0, 0, 2}}; }

TEST(MinimizeNonNegative, LeavesAMinimumThatIsAllowed) {
  QuadraticFunction f{AlikeArguments(), Eigen::Vector3d(1, 1, -4)};
  const NonNegativeMinimum found = MinimizeNonNegative(std::ref(f), {0, 1});
  // The sum of the first two is 2/1.9; the third is free.
  EXPECT_TRUE(found.at.isApprox(Eigen::Vector3d(1 / 1.9, 1 / 1.9, -2), 1e-14)) << found.at;
  EXPECT_TRUE(found.zeros.empty());
  EXPECT_EQ(f.calls, 1);
}

TEST(MinimizeNonNegative, HoldsWhatWouldBecomeNegative) {
  QuadraticFunction f{AlikeArguments(), Eigen::Vector3d(1, 0.5, -4)};
  const NonNegativeMinimum found = MinimizeNonNegative(std::ref(f), {0, 1, 2});
  // The second would be (0.5 − 0.9)/0.19 < 0; beside it at 0, the first is 1.
  EXPECT_TRUE(found.at.isApprox(Eigen::Vector3d(1, 0, 0), 1e-14)) << found.at;
  EXPECT_EQ(found.zeros, (std::vector<Eigen::Index>{1, 2}));
}

// Free, both are negative, at (−0.1, −1), but the first one only because of the second: with that
// at 0, it is b₀ = −0.1 + 0.99.
TEST(MinimizeNonNegative, ReleasesWhatAnotherHadPulledBelowZero) {
  QuadraticFunction f{Eigen::Matrix2d{{1, -0.99}, {-0.99, 1}}, {}};
  f.b = f.H * Eigen::Vector2d(-0.1, -1);
  const NonNegativeMinimum found = MinimizeNonNegative(std::ref(f), {0, 1});
  EXPECT_TRUE(found.at.isApprox(Eigen::Vector2d(0.89, 0), 1e-14)) << found.at;
  EXPECT_EQ(found.zeros, (std::vector<Eigen::Index>{1}));
}

// Slopes that are wrong in sign, as by rounding, where nothing is gained: the search ends.
TEST(MinimizeNonNegative, EndsWhereASlopePromisesWhatIsNotThere) {
  QuadraticFunction f{Eigen::Matrix2d::Identity(), Eigen::Vector2d(-1, -2)};
  const auto misled = [&](const std::vector<Eigen::Index>& zeros) {
    MinimumWithZeros minimum = f(zeros);
    minimum.slopes.setConstant(-1);
    return minimum;
  };
  const NonNegativeMinimum found = MinimizeNonNegative(misled, {0, 1});
  EXPECT_EQ(found.at, Eigen::Vector2d(0, 0));
  EXPECT_LT(f.calls, 10);
}

}  // namespace
}  // namespace lacuna
