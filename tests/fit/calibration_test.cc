#include "fit/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace lacuna {
namespace {

// a·exp(−t/τ) at 40 times, with noise of a given deviation, which is also the unit of the residual.
struct Decay {
  Eigen::VectorXd times = Eigen::VectorXd::LinSpaced(40, 0, 2);
  Eigen::VectorXd measured;
  double noise = 0.01;

  Decay(double amplitude, double tau, unsigned seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, noise);
    measured = amplitude * (-times / tau).array().exp().matrix();
    for (double& value : measured) value += normal(random);
  }

  Prediction operator()(const Eigen::VectorXd& at, bool with_jacobian) const {
    const Eigen::VectorXd shape = (-times / at[1]).array().exp();
    Prediction prediction{true, "", (at[0] * shape - measured) / noise, {}};
    if (with_jacobian) {
      prediction.jacobian.resize(times.size(), 2);
      prediction.jacobian.col(0) = shape / noise;
      prediction.jacobian.col(1) = at[0] * shape.cwiseProduct(times) / (at[1] * at[1] * noise);
    }
    return prediction;
  }
};

std::vector<CalibratedParameter> AmplitudeAndTime() {
  return {{.name = "amplitude", .start = 1, .min = 0, .max = 10, .typical = 1},
          {.name = "tau", .start = 0.2, .min = 0.01, .max = 100, .log_scale = true}};
}

TEST(Calibration, RecoversParametersWithinItsIntervals) {
  // For 95 % of 300 intervals the binomial standard deviation is 1.3 %; 91 to 99 % is three of
  // these.
  int covered[2] = {0, 0};
  constexpr int kTrials = 300;
  for (unsigned seed = 0; seed < kTrials; ++seed) {
    const Calibration found = Calibrate(AmplitudeAndTime(), Decay(2, 0.7, seed));
    ASSERT_TRUE(found.usable) << found.message;
    EXPECT_NEAR(found.parameters[0], 2, 0.04);
    EXPECT_NEAR(found.parameters[1], 0.7, 0.03);
    EXPECT_NEAR(found.rms, 1, 0.5);
    const double truth[2] = {2, 0.7};
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(found.estimates[k].determination, Determination::kPinnedDown);
      covered[k] += found.estimates[k].low <= truth[k] && truth[k] <= found.estimates[k].high;
    }
  }
  for (const int count : covered) {
    EXPECT_GE(count, 0.91 * kTrials);
    EXPECT_LE(count, 0.99 * kTrials);
  }
}

TEST(Calibration, ItsIntervalsCoverTheTruthUnderCorrelatedErrors) {
  // A constant and a slope, in six series of 50 frames, with a lag-one correlation of 0.5 of the
  // errors.
  constexpr int kTrials = 300, kSeries = 6, kRows = 50 * kSeries;
  constexpr double kMemory = 0.5;
  Eigen::MatrixXd jacobian(kRows, 2);
  std::vector<Eigen::Index> before;
  for (Eigen::Index row = 0; row < kRows; ++row) {
    jacobian.row(row) << 1, static_cast<double>(row) / kRows;
    before.push_back(row < kSeries ? -1 : row - kSeries);
  }
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  int covered[2][2] = {{0, 0}, {0, 0}};
  for (int trial = 0; trial < kTrials; ++trial) {
    Eigen::VectorXd error(kRows);
    for (Eigen::Index row = 0; row < kRows; ++row)
      error[row] = row < kSeries ? normal(random)
                                 : kMemory * error[row - kSeries] +
                                       std::sqrt(1 - kMemory * kMemory) * normal(random);
    for (const bool is_ordered : {false, true}) {
      const Calibration found = Calibrate(
          {{.name = "constant"}, {.name = "slope"}}, [&](const Eigen::VectorXd& at, bool) {
            return Prediction{true, "", jacobian * at + error, jacobian,
                              is_ordered ? before : std::vector<Eigen::Index>{}};
          });
      ASSERT_TRUE(found.usable) << found.message;
      for (int k = 0; k < 2; ++k)
        covered[is_ordered][k] += found.estimates[k].low <= 0 && 0 <= found.estimates[k].high;
    }
  }
  for (int k = 0; k < 2; ++k) {
    // Intervals for independent errors would be too narrow by √3 and cover 74 %. The correct ones
    // cover 95 ± 1.3 %, less a little because the correlation is estimated from fitted residuals.
    EXPECT_LE(covered[false][k], 0.82 * kTrials);
    EXPECT_GE(covered[true][k], 0.91 * kTrials);
    EXPECT_LE(covered[true][k], 0.99 * kTrials);
  }
}

TEST(Calibration, ReportsParametersThatTheDataDoNotDetermine) {
  // r = θ0 + θ1 − 1 + 0·θ2 + 1e-3·θ3: two interchangeable parameters, one without influence, and
  // one with little influence.
  const auto predict = [](const Eigen::VectorXd& at, bool) {
    Prediction prediction{true, "", Eigen::VectorXd(8), Eigen::MatrixXd::Zero(8, 4)};
    for (int i = 0; i < 8; ++i) {
      prediction.residual[i] = 10 * (at[0] + at[1] - 1) + 1e-3 * (i % 2) * at[3];
      prediction.jacobian.row(i) << 10, 10, 0, 1e-3 * (i % 2);
    }
    return prediction;
  };
  const Calibration found = Calibrate(
      {{.name = "a"}, {.name = "b", .prior_deviation = 3}, {.name = "c"}, {.name = "d"}}, predict);
  ASSERT_EQ(found.estimates.size(), 4u);
  EXPECT_EQ(found.estimates[0].determination, Determination::kTradedOff);
  EXPECT_EQ(found.estimates[0].traded_with, "b");
  EXPECT_EQ(found.estimates[1].determination, Determination::kTradedOff);
  EXPECT_NEAR(found.estimates[1].posterior_deviation, 3, 1e-3);  // that of the prior
  EXPECT_EQ(found.estimates[2].determination, Determination::kDead);
  EXPECT_TRUE(std::isinf(found.estimates[2].posterior_deviation));
  EXPECT_EQ(found.estimates[3].determination, Determination::kFlat);
}

TEST(Calibration, DoesNotDependOnTheUnitsOfOtherParameters) {
  // Beside a modulus of 80 000 Pa without influence, a step of 0.3 N must not count as negligible.
  const auto predict = [](const Eigen::VectorXd& at, bool) {
    Prediction prediction{true, "", Eigen::VectorXd(8), Eigen::MatrixXd::Zero(8, 2)};
    prediction.residual.setConstant(50 * (at[1] - 0.3));
    prediction.jacobian.col(1).setConstant(50);
    return prediction;
  };
  const Calibration found = Calibrate(
      {{.name = "modulus", .start = 8e4, .typical = 1e5}, {.name = "force", .start = 0}}, predict);
  EXPECT_NEAR(found.parameters[1], 0.3, 1e-6);
}

TEST(Calibration, StaysWithinBoundsAndReportsIt) {
  auto parameters = AmplitudeAndTime();
  parameters[0].max = 1.5;
  const Calibration found = Calibrate(parameters, Decay(2, 0.7, 1));
  EXPECT_DOUBLE_EQ(found.parameters[0], 1.5);
  EXPECT_EQ(found.estimates[0].determination, Determination::kAtBound);
}

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
      Prediction prediction{true, "", (swing(at) - measured) / 0.001, {}};
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
    Prediction prediction{true, "", Eigen::VectorXd::Constant(3, at[0] + 2), {}};
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

// In SI units the value and its bounds differ by less than a millionth.
TEST(Calibration, ASmallParameterOnALogarithmicScaleIsNotAtItsBound) {
  const auto determination = [](double wanted) {
    const auto predict = [&](const Eigen::VectorXd& at, bool) {
      Prediction prediction{
          true, "", Eigen::VectorXd::Constant(3, 100 * std::log(at[0] / wanted)), {}};
      prediction.jacobian = Eigen::MatrixXd::Constant(3, 1, 100 / at[0]);
      return prediction;
    };
    return Calibrate({{.name = "a", .start = 1e-6, .min = 1e-7, .max = 1e-5, .log_scale = true}},
                     predict)
        .estimates.at(0)
        .determination;
  };
  EXPECT_EQ(determination(2e-7), Determination::kPinnedDown);
  EXPECT_EQ(determination(5e-8), Determination::kAtBound);
}

TEST(Calibration, ApproachesAnOpenBoundInParts) {
  const CalibratedParameter parameter{
      .name = "a", .start = 0.5, .min = 0, .max = 1, .open_max = true};
  std::vector<double> tried;
  const Calibration fitted = Calibrate({parameter}, [&](const Eigen::VectorXd& at, bool) {
    tried.push_back(at[0]);
    return Prediction{true, "", Eigen::VectorXd::Constant(100, 100 * (at[0] - 2)),
                      Eigen::MatrixXd::Constant(100, 1, 100)};
  });
  ASSERT_GE(tried.size(), 3u);
  EXPECT_NEAR(tried[1], 0.9, 1e-12);
  EXPECT_NEAR(tried[2], 0.98, 1e-12);
  EXPECT_GT(fitted.parameters[0], 0.98);
  EXPECT_LT(*std::max_element(tried.begin(), tried.end()), 1);
}

TEST(Calibration, WidensItsIntervalsIfTheModelDoesNotFit) {
  Decay decay(2, 0.7, 1);
  const Calibration good = Calibrate(AmplitudeAndTime(), decay);
  decay.measured.array() += 0.2 * (7 * decay.times.array()).sin();
  const Calibration poor = Calibrate(AmplitudeAndTime(), decay);
  EXPECT_GT(poor.inflation, 5);
  EXPECT_NEAR(poor.estimates[1].posterior_deviation / good.estimates[1].posterior_deviation,
              poor.inflation / good.inflation, 0.3 * poor.inflation);
}

// A scan that sees half of the patches: the rows of the others are 0.
TEST(Calibration, CountsOnlyTheRowsThatWereObserved) {
  constexpr Eigen::Index kObserved = 100;
  constexpr double kMisfit = 3;
  const auto fit = [](Eigen::Index unobserved) {
    return Calibrate({{.name = "a", .start = 1}}, [=](const Eigen::VectorXd& at, bool) {
      const Eigen::Index rows = kObserved + unobserved;
      Prediction prediction{true, "", Eigen::VectorXd::Zero(rows), Eigen::MatrixXd::Zero(rows, 1)};
      for (Eigen::Index row = 0; row < kObserved; ++row)
        prediction.residual[row] = at[0] + (row % 2 == 0 ? kMisfit : -kMisfit);
      prediction.jacobian.topRows(kObserved).setOnes();
      prediction.unobserved = unobserved;
      return prediction;
    });
  };
  const Calibration all = fit(0), half = fit(kObserved);
  ASSERT_TRUE(all.usable && half.usable) << all.message << half.message;
  EXPECT_NEAR(all.rms, kMisfit, 1e-9);
  EXPECT_NEAR(half.rms, all.rms, 1e-9);
  EXPECT_NEAR(half.start_rms, std::hypot(1, kMisfit), 1e-9);
  EXPECT_NEAR(half.inflation, kMisfit, 1e-9);
  EXPECT_NEAR(half.estimates[0].deviation, all.estimates[0].deviation, 1e-9);
}

TEST(Calibration, AnIntervalIsCentredWhereKnownErrorsPutIt) {
  CalibratedParameter modulus;
  modulus.min = 1e3;
  modulus.max = 1e6;
  modulus.log_scale = true;
  ParameterEstimate estimate;
  estimate.value = 1e5;
  estimate.posterior_deviation = 0.03;
  CountModelErrors(modulus, 2e5, 0.04, &estimate);
  EXPECT_NEAR(std::log(estimate.high / 2e5), 1.96 * 0.05, 1e-4);
  EXPECT_NEAR(std::log(estimate.low / 2e5), -1.96 * 0.05, 1e-4);
  EXPECT_EQ(estimate.posterior_deviation, 0.03);
  EXPECT_EQ(estimate.value, 1e5);
  CountModelErrors(modulus, 9e5, 1, &estimate);
  EXPECT_EQ(estimate.high, 1e6) << "the upper bound";
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
    return Prediction{true, "", Eigen::VectorXd::Constant(100, 2 + std::abs(at[0])),
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

// Rosenbrock's valley: full steps leave it, so that the search ends early if it takes the short
// steps that are left for the smallness of what remains.
TEST(Calibration, FollowsACurvedValleyToItsEnd) {
  const auto valley = [](const Eigen::VectorXd& at, bool) {
    const double steep = 100;
    Prediction prediction{true, "", Eigen::VectorXd(2), Eigen::MatrixXd(2, 2)};
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
    Prediction prediction{true, "", Eigen::VectorXd(2), Eigen::MatrixXd(2, 1)};
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

// A motion may be simulated where its derivative cannot be computed.
TEST(Calibration, ReportsASolutionThatCannotBeLinearised) {
  const Decay decay(2, 0.7, 1);
  const auto only_at_start = [&](const Eigen::VectorXd& at, bool with_jacobian) {
    Prediction prediction = decay(at, with_jacobian);
    if (with_jacobian && at[1] > 0.3) return Prediction{false, "not definite", {}, {}};
    return prediction;
  };
  const Calibration found = Calibrate(AmplitudeAndTime(), only_at_start);
  EXPECT_FALSE(found.usable);
  EXPECT_THAT(found.message, testing::HasSubstr("not definite"));
}

// Where the derivatives fail on the way, the search takes shorter steps from where it had them.
TEST(Calibration, GoesOnFromWhereItHadDerivatives) {
  const Decay decay(2, 0.7, 1);
  int differentiated = 0;
  const Calibration found =
      Calibrate(AmplitudeAndTime(), [&](const Eigen::VectorXd& at, bool with_jacobian) {
        if (with_jacobian && ++differentiated == 2) return Prediction{false, "failed once", {}, {}};
        return decay(at, with_jacobian);
      });
  EXPECT_TRUE(found.usable) << found.message;
  EXPECT_GT(differentiated, 2);
  const Calibration expected = Calibrate(AmplitudeAndTime(), decay);
  for (int k = 0; k < 2; ++k)
    EXPECT_NEAR(found.parameters[k], expected.parameters[k],
                0.3 * expected.estimates[static_cast<size_t>(k)].deviation);
}

TEST(Calibration, ReportsAFailedPrediction) {
  const auto fails = [](const Eigen::VectorXd&, bool) {
    return Prediction{false, "element 3 is inverted", {}, {}};
  };
  const Calibration found = Calibrate(AmplitudeAndTime(), fails);
  EXPECT_FALSE(found.usable);
  EXPECT_THAT(found.message, testing::HasSubstr("element 3"));
}

}  // namespace
}  // namespace lacuna
