#include "fit/prior_cost.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace lacuna {
namespace {

// A modulus on a logarithmic scale, a ratio, and a parameter without a prior.
std::vector<CalibratedParameter> ThreeParameters() {
  CalibratedParameter modulus{.name = "modulus", .start = 1e5, .log_scale = true};
  modulus.prior_deviation = 0.5;
  CalibratedParameter ratio{.name = "ratio", .start = 0.4};
  ratio.prior_mean = 0.3;
  ratio.prior_deviation = 0.1;
  return {modulus, ratio, {.name = "free", .start = 2}};
}

TEST(PriorCost, CountsTheDistanceFromTheMeanInDeviations) {
  const std::vector<CalibratedParameter> parameters = ThreeParameters();
  EXPECT_DOUBLE_EQ(FromPriorMean(parameters[0], 1e5 * std::exp(1.5)), 3);
  EXPECT_DOUBLE_EQ(FromPriorMean(parameters[1], 0.25), -0.5);
  EXPECT_EQ(FromPriorMean(parameters[2], 1e9), 0);
  const Eigen::Vector3d values(1e5 * std::exp(1.5), 0.25, 7);
  EXPECT_DOUBLE_EQ(CostAt(parameters, values, Eigen::Vector2d(1, 2)), 0.5 * (1 + 4 + 9 + 0.25));
}

// With a residual that is linear in the free values, the model is the cost itself.
TEST(PriorCost, IsQuadraticInTheFreeValuesWhereTheResidualIsLinear) {
  const std::vector<CalibratedParameter> parameters = ThreeParameters();
  const Eigen::Vector3d values(2e5, 0.35, 5), step(0.2, -0.03, 0.7);
  const Eigen::Vector4d residual(0.3, -1, 2, 0.5);
  Eigen::MatrixXd by_free(4, 3);
  by_free << 1, 2, 0, -1, 3, 0.5, 0.2, 0, 1, 4, -2, 0.1;
  Eigen::MatrixXd columns = by_free;
  columns.col(0) /= values[0];  // ∂r/∂θ of the modulus
  DeriveByFreeValues(parameters, values, &columns);
  EXPECT_LT((columns - by_free).norm(), 1e-14);

  const QuadraticCost model = CostAbout(parameters, values, residual, columns);
  const Eigen::Vector3d moved(values[0] * std::exp(step[0]), values[1] + step[1],
                              values[2] + step[2]);
  EXPECT_NEAR(model.cost + model.gradient.dot(step) + 0.5 * step.dot(model.information * step),
              CostAt(parameters, moved, residual + by_free * step), 1e-12);
}

}  // namespace
}  // namespace lacuna
