#include "fit/active_bounds.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/QR>
#include <limits>
#include <random>
#include <vector>

namespace lacuna {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

QuadraticCost CostOf(const Eigen::MatrixXd& J, const Eigen::VectorXd& r) {
  return {0.5 * r.squaredNorm(), J.transpose() * r, J.transpose() * J};
}

TEST(StepWithin, AccountsForBoundsInAllParameters) {
  // Two parameters with nearly the same effect. Both gradients point inwards, but the unconstrained
  // minimum of one parameter lies outside of its bounds.
  Eigen::MatrixXd J(3, 2);
  J << 1, 1.01, 1, 0.99, 0.1, 0.1;
  const QuadraticCost model = CostOf(J, -J * Eigen::Vector2d(-5, 7));
  EXPECT_LT(model.gradient[0], 0);
  const Eigen::Vector2d far(kInfinity, kInfinity);
  const Eigen::VectorXd free = StepWithin(model, -far, far);
  EXPECT_NEAR(free[0], -5, 1e-6);
  EXPECT_NEAR(free[1], 7, 1e-6);
  EXPECT_NEAR(model.GainOf(free), 1, 1e-9);
  for (const double low : {0.0, -1.0}) {
    const Eigen::VectorXd within = StepWithin(model, Eigen::Vector2d(low, 0), far);
    EXPECT_EQ(within[0], low);
    EXPECT_NEAR(within[1], 2 - (low < 0 ? low : 0), 0.1);
  }
}

TEST(StepWithin, DoesNotMoveParametersWithoutInfluence) {
  Eigen::MatrixXd J = Eigen::MatrixXd::Identity(3, 3);
  J(1, 1) = 0;
  const Eigen::Vector3d far = Eigen::Vector3d::Constant(kInfinity);
  EXPECT_EQ(StepWithin(CostOf(J, Eigen::Vector3d(-1, 2, 3)), -far, far)[1], 0);
}

// Compares with all active sets whose free parameters have their minimum within the bounds.
TEST(StepWithin, HasTheLeastCostOfAllActiveSets) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  constexpr int kCount = 4;
  for (int trial = 0; trial < 300; ++trial) {
    Eigen::MatrixXd J(8, kCount);
    Eigen::VectorXd r(8), low(kCount), high(kCount);
    for (double& value : J.reshaped()) value = normal(random);
    J.col(1) = J.col(0) + 0.05 * J.col(1);
    for (double& value : r) value = normal(random);
    for (int k = 0; k < kCount; ++k) {
      low[k] = trial % 3 == k ? 0 : -std::abs(normal(random));
      high[k] = trial % 2 == 0 && k == 3 ? 0 : std::abs(normal(random));
    }
    const QuadraticCost model = CostOf(J, r);
    double best = -1;
    for (int set = 0; set < 81; ++set) {
      Eigen::VectorXd step = Eigen::VectorXd::Zero(kCount);
      std::vector<int> free;
      for (int k = 0, digits = set; k < kCount; ++k, digits /= 3) {
        if (digits % 3 == 0) free.push_back(k);
        step[k] = digits % 3 == 1 ? low[k] : digits % 3 == 2 ? high[k] : 0;
      }
      if (!free.empty()) {
        const Eigen::MatrixXd theirs = J(Eigen::all, free);
        const Eigen::VectorXd residual = r + J * step;
        step(free) = -theirs.colPivHouseholderQr().solve(residual);
      }
      const double slack = 1e-12;
      if ((step - low).minCoeff() >= -slack && (high - step).minCoeff() >= -slack)
        best = std::max(best, model.GainOf(step));
    }
    const Eigen::VectorXd found = StepWithin(model, low, high);
    EXPECT_NEAR(model.GainOf(found), best, 1e-9) << trial;
    EXPECT_GE((found - low).minCoeff(), 0) << trial;
    EXPECT_GE((high - found).minCoeff(), 0) << trial;
  }
}

}  // namespace
}  // namespace lacuna
