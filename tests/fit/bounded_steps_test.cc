#include "fit/bounded_steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace lacuna {
namespace {

constexpr double kUnlimited = std::numeric_limits<double>::infinity();

// A cost of which the unlimited step of one parameter, with this information, is `step`.
QuadraticCost CostWithStep(double step, double information = 1) {
  return {1, Eigen::VectorXd::Constant(1, -information * step),
          Eigen::MatrixXd::Constant(1, 1, information)};
}

// The value after the best step from `value`.
double Next(const CalibratedParameter& parameter, double value, double step) {
  const std::vector<CalibratedParameter> parameters{parameter};
  const BoundedSteps steps(parameters);
  const Eigen::VectorXd values = Eigen::VectorXd::Constant(1, value);
  return steps.Moved(steps.Step(CostWithStep(step), values, kUnlimited), values)[0];
}

TEST(BoundedSteps, ReachABoundExactlyAndLeaveAPartOfTheWayToAnOpenOne) {
  CalibratedParameter parameter{.name = "a", .min = 0, .max = 0.3};
  EXPECT_EQ(Next(parameter, 0.1, 1), 0.3);
  EXPECT_EQ(Next(parameter, 0.1, -1), 0);
  EXPECT_NEAR(Next(parameter, 0.1, 0.05), 0.15, 1e-12) << "a step within the bounds";
  parameter.open_max = true;
  EXPECT_NEAR(Next(parameter, 0.1, 1), 0.1 + 0.8 * 0.2, 1e-12);
}

TEST(BoundedSteps, AreNotLongerThanAHundredTypicalChangesOrAFactorOfE) {
  EXPECT_NEAR(Next({.name = "a", .typical = 2}, 1, 1e6), 1 + 200, 1e-9);
  EXPECT_NEAR(Next({.name = "a", .min = 0, .log_scale = true}, 3, -5), 3 / std::exp(1), 1e-12);
}

TEST(BoundedSteps, ReachTheRadiusOfTheTrustRegion) {
  const std::vector<CalibratedParameter> parameters{{.name = "a"}, {.name = "b", .typical = 0.1}};
  const BoundedSteps steps(parameters);
  const QuadraticCost model{1, Eigen::Vector2d(-1, -4), Eigen::Vector2d(1, 25).asDiagonal()};
  const Eigen::VectorXd values = Eigen::VectorXd::Zero(2);
  const Eigen::VectorXd full = steps.Step(model, values, kUnlimited);
  EXPECT_NEAR((full - Eigen::Vector2d(1, 0.16)).norm(), 0, 1e-12);
  const double radius = 0.5 * BoundedSteps::LengthOf(full, model);
  const double length = BoundedSteps::LengthOf(steps.Step(model, values, radius), model);
  EXPECT_LE(length, radius);
  EXPECT_GT(length, 0.9 * radius) << "λ is found to a factor of 1.12";
  EXPECT_NEAR(steps.LargestChange(full), 1.6, 1e-12);
}

TEST(BoundedSteps, AStepThatIsTooLongIsLimitedInEachComponent) {
  const std::vector<CalibratedParameter> parameters{{.name = "a", .max = 1}, {.name = "b"}};
  const Eigen::VectorXd limited =
      BoundedSteps(parameters).Limited(Eigen::Vector2d(3, 3), Eigen::Vector2d(0.5, 0));
  EXPECT_NEAR((limited - Eigen::Vector2d(0.5, 3)).norm(), 0, 1e-12);
}

}  // namespace
}  // namespace lacuna
