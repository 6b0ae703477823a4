#include "search/trust_region_step.h"

#include <gtest/gtest.h>

#include <cmath>

#include "search/problem_collection.h"
#include "search/search_problem.h"

namespace lacuna {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::VectorXd;

LinearInterpolant RandomModel(int n, int m, uint64_t seed) {
  const auto number = [&seed] { return 2 * UniformOf(seed++) - 1; };
  LinearInterpolant model;
  model.gradient = VectorXd::NullaryExpr(n, number);
  model.constraints = 0.5 * VectorXd::NullaryExpr(m, number);
  model.jacobian = MatrixXd::NullaryExpr(m, n, number);
  return model;
}

double ViolationAfter(const LinearInterpolant& model, const VectorXd& d) {
  return Violation(model.constraints + model.jacobian * d);
}

TEST(TrustRegionStep, WithoutConstraintsIsSteepestDescentToTheBoundary) {
  LinearInterpolant model;
  model.gradient = Vector2d(3, 4);
  model.jacobian.resize(0, 2);
  const VectorXd infinite = VectorXd::Constant(2, INFINITY);
  const TrustRegionStep trial = SolveTrustRegion(model, -infinite, infinite, 0.5);
  EXPECT_TRUE(trial.on_boundary);
  EXPECT_NEAR((trial.step - Vector2d(-0.3, -0.4)).norm(), 0, 1e-15);  // rounding
}

TEST(TrustRegionStep, OfAConstantModelIsZero) {
  LinearInterpolant model;
  model.gradient = Vector2d::Zero();
  model.jacobian = MatrixXd::Zero(1, 2);
  model.constraints = VectorXd::Constant(1, -1);
  const TrustRegionStep trial = SolveTrustRegion(model, Vector2d(-1, -1), Vector2d(1, 1), 0.5);
  EXPECT_FALSE(trial.on_boundary);
  EXPECT_EQ(trial.step.norm(), 0);
}

// No point of a dense sample of the ball and box has a smaller violation, or an equal one with a
// lower objective. The margin of 1e-9 is for rounding; that of the objective is the change that
// such a small excess of violation could cause.
TEST(TrustRegionStep, NoOtherPointOfTheBallAndBoxIsBetter) {
  for (uint64_t trial = 0; trial < 300; ++trial) {
    const int n = 2 + static_cast<int>(trial % 2);
    const int m = static_cast<int>(trial % 6);
    LinearInterpolant model = RandomModel(n, m, 1000 * trial);
    if (m > 2) model.jacobian.row(1) = model.jacobian.row(0);       // parallel
    if (m > 3) model.jacobian.row(2) = -2 * model.jacobian.row(0);  // opposed
    const VectorXd lower = VectorXd::Constant(n, trial % 3 == 0 ? -0.4 : -2);
    const VectorXd upper = VectorXd::Constant(n, trial % 4 == 0 ? 0.0 : 2);
    const TrustRegionStep solved = SolveTrustRegion(model, lower, upper, 1);
    EXPECT_LE(solved.step.norm(), 1 + 1e-12);
    EXPECT_TRUE((solved.step.array() >= lower.array() - 1e-12).all());
    EXPECT_TRUE((solved.step.array() <= upper.array() + 1e-12).all());
    const double violation = ViolationAfter(model, solved.step);
    const double value = model.gradient.dot(solved.step);
    for (int k = 0; k < 4000; ++k) {
      VectorXd d(n);
      for (int i = 0; i < n; ++i) d[i] = 2 * UniformOf(7 * k + i) - 1;
      if (k % 2 == 0) d.normalize();
      if (k % 5 == 0) d = solved.step + 0.02 * d;
      d = d.cwiseMax(lower).cwiseMin(upper);
      if (d.norm() > 1) continue;
      ASSERT_GE(ViolationAfter(model, d), violation - 1e-9) << "trial " << trial;
      if (ViolationAfter(model, d) <= violation) {
        ASSERT_GE(model.gradient.dot(d), value - 1e-9) << "trial " << trial;
      }
    }
  }
}

// For a constant objective the result is the shortest feasible step.
TEST(TrustRegionStep, IsTheShortestOfEqualSteps) {
  LinearInterpolant model;
  model.gradient = Vector2d::Zero();
  model.constraints = VectorXd::Constant(1, -0.3);
  model.jacobian = Eigen::RowVector2d(0.6, 0.8);
  const TrustRegionStep trial = SolveTrustRegion(model, Vector2d(-1, -1), Vector2d(1, 1), 1);
  EXPECT_NEAR((trial.step - 0.3 * Vector2d(0.6, 0.8)).norm(), 0, 1e-15);  // rounding
}

}  // namespace
}  // namespace lacuna
