// How a calibration searches for its parameters: bounds, steps, predictions, and where it ends.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "fit/calibration.h"
#include "fit/decay.h"

namespace lacuna {
namespace {

// Two kinds of damping with nearly the same effect, both bounded below by 0. The fit starts near
// the bound of one of them or passes it, and has to leave the bound or to stay on it.
TEST(Calibration, IsNotTrappedAtABound) {
  const Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(80, 0, 2);
  const auto swing = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
    const Eigen::ArrayXd rate = at[0] + at[1] * (1 + 0.1 * times.array());
    return (-rate * times.array()).exp() * (at[2] * times.array()).cos();
  };
  for (const Eigen::Vector3d& truth :
       {Eigen::Vector3d(1.5, 0, 20), Eigen::Vector3d(0, 1.5, 20), Eigen::Vector3d(0.7, 0.7, 20)}) {
    std::mt19937 random(5);
    std::normal_distribution<double> noise(0, 0.001);
    Eigen::VectorXd measured = swing(truth);
    for (double& value : measured) value += noise(random);
    const double best = RootMeanSquare({true, "", (swing(truth) - measured) / 0.001, {}});
    const auto predict = [&](const Eigen::VectorXd& at, bool) {
      ResidualEvaluation prediction{true, "", (swing(at) - measured) / 0.001, {}};
      prediction.jacobian.resize(times.size(), 3);
      for (int k = 0; k < 3; ++k) {
        Eigen::VectorXd to = at, from = at;
        to[k] += 1e-6;
        from[k] -= 1e-6;
        prediction.jacobian.col(k) = (swing(to) - swing(from)) / (2e-6 * 0.001);
      }
      return prediction;
    };
    for (const Eigen::Vector2d& start : {Eigen::Vector2d(4e-6, 0.1), Eigen::Vector2d(1e-4, 10),
                                         Eigen::Vector2d(10, 1e-4), Eigen::Vector2d(1, 1)}) {
      const Calibration found =
          Calibrate({{.name = "a", .start = start[0], .min = 0, .max = 300, .typical = 150},
                     {.name = "b", .start = start[1], .min = 0, .max = 300, .typical = 150},
                     {.name = "frequency", .start = 19.7, .min = 0, .max = 1e3, .log_scale = true}},
                    predict);
      EXPECT_TRUE(found.usable) << found.message;
      EXPECT_LT(found.rms, 1.02 * best)
          << truth.transpose() << " from " << start.transpose() << ", " << found.iterations;
    }
  }
}

// Once the only parameter is at its bound, nothing remains to be searched.
TEST(Calibration, EndsAtTheBoundIfItsOnlyParameterWouldFitBeyondIt) {
  const auto predict = [](const Eigen::VectorXd& at, bool) {
    ResidualEvaluation prediction{true, "", Eigen::VectorXd::Constant(3, at[0] + 2), {}};
    prediction.jacobian = Eigen::MatrixXd::Ones(3, 1);
    return prediction;
  };
  for (const double start : {5.0, 0.0}) {
    const Calibration found =
        Calibrate({{.name = "a", .start = start, .min = 0, .max = 10, .typical = 1}}, predict);
    EXPECT_TRUE(found.usable) << found.message;
    EXPECT_EQ(found.parameters[0], 0);
    EXPECT_GE(found.iterations, 0);
    EXPECT_EQ(found.estimates[0].determination, Determination::kAtBound);
  }
}

TEST(Calibration, ApproachesAnOpenBoundInParts) {
  const CalibratedParameter parameter{
      .name = "a", .start = 0.5, .min = 0, .max = 1, .open_max = true};
  std::vector<double> tried;
  const Calibration fitted = Calibrate({parameter}, [&](const Eigen::VectorXd& at, bool) {
    tried.push_back(at[0]);
    return ResidualEvaluation{true, "", Eigen::VectorXd::Constant(100, 100 * (at[0] - 2)),
                              Eigen::MatrixXd::Constant(100, 1, 100)};
  });
  ASSERT_GE(tried.size(), 3u);
  EXPECT_NEAR(tried[1], 0.9, 1e-12);
  EXPECT_NEAR(tried[2], 0.98, 1e-12);
  EXPECT_GT(fitted.parameters[0], 0.98);
  EXPECT_LT(*std::max_element(tried.begin(), tried.end()), 1);
}

TEST(Calibration, MakesFewPredictionsNearTheSolution) {
  const Decay decay(2, 0.7, 1);
  auto parameters = AmplitudeAndTime();
  parameters[0].start = 1.9;
  parameters[1].start = 0.65;
  const Calibration near = Calibrate(parameters, decay);
  ASSERT_TRUE(near.usable) << near.message;
  EXPECT_LE(near.predictions, 4);
  // At the solution, one prediction shows that there is nothing to gain.
  for (int k = 0; k < 2; ++k) parameters[k].start = near.parameters[k];
  const Calibration again = Calibrate(parameters, decay);
  EXPECT_TRUE(again.usable);
  EXPECT_EQ(again.predictions, 1);
  EXPECT_EQ(again.parameters, near.parameters);
}

TEST(Calibration, EndsIfTheStepThatTheJacobianPredictsGainsNothing) {
  // At the bottom of a kink the derivative predicts half the residual, but every step increases it.
  const auto kink = [](const Eigen::VectorXd& at, bool) {
    return ResidualEvaluation{true, "", Eigen::VectorXd::Constant(100, 2 + std::abs(at[0])),
                              Eigen::MatrixXd::Constant(100, 1, at[0] < 0 ? -1 : 1)};
  };
  const Calibration found = Calibrate({{.name = "x", .start = 0}}, kink);
  EXPECT_TRUE(found.usable) << found.message;
  EXPECT_NEAR(found.parameters[0], 0, 1e-2);
  EXPECT_LE(found.predictions, 15);
}

// Derivatives cost several times as much as a prediction.
TEST(Calibration, ComputesDerivativesAtTheStartAndAtTheEndOnly) {
  const Decay decay(2, 0.7, 1);
  std::vector<CalibratedParameter> parameters = AmplitudeAndTime();
  parameters[1].start = 0.3;  // less than a factor of e away, which one step may change
  int plain = 0, differentiated = 0;
  const Calibration found =
      Calibrate(parameters, [&](const Eigen::VectorXd& at, bool with_jacobian) {
        ++(with_jacobian ? differentiated : plain);
        return decay(at, with_jacobian);
      });
  ASSERT_TRUE(found.usable) << found.message;
  EXPECT_EQ(differentiated, 2);
  EXPECT_GT(plain, 2);
  EXPECT_EQ(found.predictions, plain + differentiated);
  // The intervals are those of the derivatives at the end, not of secants.
  std::vector<CalibratedParameter> there = AmplitudeAndTime();
  for (size_t k = 0; k < there.size(); ++k)
    there[k].start = found.parameters[static_cast<Eigen::Index>(k)];
  const Calibration again = Calibrate(there, decay);
  ASSERT_EQ(again.predictions, 1);
  for (size_t k = 0; k < there.size(); ++k)
    EXPECT_EQ(found.estimates[k].deviation, again.estimates[k].deviation);
}

// Where the derivatives fail on the way, the search takes shorter steps from where it had them.
TEST(Calibration, GoesOnFromWhereItHadDerivatives) {
  const Decay decay(2, 0.7, 1);
  int differentiated = 0;
  const Calibration found =
      Calibrate(AmplitudeAndTime(), [&](const Eigen::VectorXd& at, bool with_jacobian) {
        if (with_jacobian && ++differentiated == 2)
          return ResidualEvaluation{false, "failed once", {}, {}};
        return decay(at, with_jacobian);
      });
  EXPECT_TRUE(found.usable) << found.message;
  EXPECT_GT(differentiated, 2);
  const Calibration expected = Calibrate(AmplitudeAndTime(), decay);
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(found.parameters[k], expected.parameters[k],
                0.3 * expected.estimates[static_cast<size_t>(k)].deviation);
}

// Rosenbrock's valley: full steps leave it, so that the search ends early if it takes the short
// steps that are left for the smallness of what remains.
TEST(Calibration, FollowsACurvedValleyToItsEnd) {
  const auto valley = [](const Eigen::VectorXd& at, bool) {
    const double steep = 100;
    ResidualEvaluation prediction{true, "", Eigen::VectorXd(2), Eigen::MatrixXd(2, 2)};
    prediction.residual << steep * (at[1] - at[0] * at[0]), 10 * (1 - at[0]);
    prediction.jacobian << -2 * steep * at[0], steep, -10, 0;
    return prediction;
  };
  const Calibration found =
      Calibrate({{.name = "x", .start = -1.2}, {.name = "y", .start = 1}}, valley);
  EXPECT_TRUE(found.usable) << found.message;
  EXPECT_NEAR(found.parameters[0], 1, 0.05);
  EXPECT_NEAR(found.parameters[1], 1, 0.1);
  EXPECT_LE(found.predictions, 10) << "straight steps alone take 37";
}

// A small amplitude gives the time hardly any influence, so that a step that is limited by the
// influence alone moves it to the end of its range.
TEST(Calibration, KeepsATimeThatHasLittleInfluenceYet) {
  const Decay decay(2, 0.7, 1);
  double shortest = 1, longest = 0;
  std::vector<CalibratedParameter> parameters = AmplitudeAndTime();
  parameters[0].start = 1e-3;
  parameters[1].start = 0.2;
  const Calibration found =
      Calibrate(parameters, [&](const Eigen::VectorXd& at, bool with_jacobian) {
        shortest = std::min(shortest, at[1]);
        longest = std::max(longest, at[1]);
        return decay(at, with_jacobian);
      });
  ASSERT_TRUE(found.usable) << found.message;
  EXPECT_NEAR(found.parameters[1], 0.7, 0.05);
  EXPECT_GT(shortest, 0.2 / 3);
  EXPECT_LT(longest, 0.7 * 3);
}

TEST(Calibration, EndsWithTheBestParametersOfItsBudget) {
  const Decay decay(2, 0.7, 1);
  const Calibration whole = Calibrate(AmplitudeAndTime(), decay);
  const Calibration part = Calibrate(AmplitudeAndTime(), decay, {.max_predictions = 3});
  ASSERT_TRUE(whole.usable);
  EXPECT_FALSE(part.usable);
  EXPECT_TRUE(part.is_out_of_budget);
  EXPECT_LE(part.predictions, 4);
  EXPECT_LT(part.rms, part.start_rms);
  EXPECT_EQ(part.estimates.size(), 2u);
  EXPECT_THAT(part.message,
              testing::HasSubstr("after " + std::to_string(part.predictions) + " predictions"));
  EXPECT_FALSE(Calibrate(AmplitudeAndTime(), decay, {.max_predictions = 500}).is_out_of_budget);
}

TEST(Calibration, EndsWithTheBestParametersOfItsIterations) {
  const Decay decay(2, 0.7, 1);
  const Calibration part = Calibrate(AmplitudeAndTime(), decay, {.max_iterations = 1});
  EXPECT_FALSE(part.usable);
  EXPECT_TRUE(part.is_out_of_budget);
  EXPECT_EQ(part.iterations, 1);
  EXPECT_LT(part.rms, part.start_rms);
  EXPECT_EQ(part.estimates.size(), 2u);
  EXPECT_THAT(part.message, testing::HasSubstr("after 1 iterations"));
}

// A search that cannot come down to a rival's cost need not go on to its own end.
TEST(Calibration, EndsWhereItIsHopeless) {
  // Steps towards a double root halve the way to it. The floor is a cost of 100.
  const auto double_root = [](const Eigen::VectorXd& at, bool) {
    ResidualEvaluation prediction{true, "", Eigen::VectorXd(2), Eigen::MatrixXd(2, 1)};
    prediction.residual << 100 * at[0] * at[0], std::sqrt(200.0);
    prediction.jacobian << 200 * at[0], 0;
    return prediction;
  };
  const std::vector<CalibratedParameter> start = {{.name = "x", .start = 10}};
  const Calibration whole = Calibrate(start, double_root);
  ASSERT_TRUE(whole.usable) << whole.message;
  EXPECT_NEAR(whole.cost, 100, 1);
  EXPECT_EQ(Calibrate(start, double_root, {.hopeless_cost = 101}).parameters, whole.parameters);
  const Calibration hopeless = Calibrate(start, double_root, {.hopeless_cost = 30});
  EXPECT_FALSE(hopeless.usable);
  EXPECT_FALSE(hopeless.is_out_of_budget);
  EXPECT_LT(hopeless.predictions, whole.predictions);
  EXPECT_THAT(hopeless.message, testing::HasSubstr("close enough"));
  EXPECT_EQ(hopeless.estimates.size(), 1u);
}

}  // namespace
}  // namespace lacuna
