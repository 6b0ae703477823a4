// What a calibration says about its parameters: estimates, intervals, and what is not determined.
#include "fit/calibration.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "fit/decay.h"

namespace lacuna {
namespace {

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
            return ResidualEvaluation{true, "", jacobian * at + error, jacobian,
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
      ResidualEvaluation prediction{true, "", Eigen::VectorXd::Zero(rows),
                                    Eigen::MatrixXd::Zero(rows, 1)};
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
  WidenIntervalByModelErrors(modulus, 2e5, 0.04, &estimate);
  EXPECT_NEAR(std::log(estimate.high / 2e5), 1.96 * 0.05, 1e-4);
  EXPECT_NEAR(std::log(estimate.low / 2e5), -1.96 * 0.05, 1e-4);
  EXPECT_EQ(estimate.posterior_deviation, 0.03);
  EXPECT_EQ(estimate.value, 1e5);
  WidenIntervalByModelErrors(modulus, 9e5, 1, &estimate);
  EXPECT_EQ(estimate.high, 1e6) << "the upper bound";
}

TEST(Calibration, ReportsParametersThatTheDataDoNotDetermine) {
  // r = θ0 + θ1 − 1 + 0·θ2 + 1e-3·θ3: two interchangeable parameters, one without influence, and
  // one with little influence.
  const auto predict = [](const Eigen::VectorXd& at, bool) {
    ResidualEvaluation prediction{true, "", Eigen::VectorXd(8), Eigen::MatrixXd::Zero(8, 4)};
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
    ResidualEvaluation prediction{true, "", Eigen::VectorXd(8), Eigen::MatrixXd::Zero(8, 2)};
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

// In SI units the value and its bounds differ by less than a millionth.
TEST(Calibration, ASmallParameterOnALogarithmicScaleIsNotAtItsBound) {
  const auto determination = [](double wanted) {
    const auto predict = [&](const Eigen::VectorXd& at, bool) {
      ResidualEvaluation prediction{
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

// A motion may be simulated where its derivative cannot be computed.
TEST(Calibration, ReportsASolutionThatCannotBeLinearised) {
  const Decay decay(2, 0.7, 1);
  const auto only_at_start = [&](const Eigen::VectorXd& at, bool with_jacobian) {
    ResidualEvaluation prediction = decay(at, with_jacobian);
    if (with_jacobian && at[1] > 0.3) return ResidualEvaluation{false, "not definite", {}, {}};
    return prediction;
  };
  const Calibration found = Calibrate(AmplitudeAndTime(), only_at_start);
  EXPECT_FALSE(found.usable);
  EXPECT_THAT(found.message, testing::HasSubstr("not definite"));
}

// There is nothing to estimate; the prediction is judged all the same.
TEST(Calibration, HasASolutionWithoutParameters) {
  const auto predict_as = [](bool usable) {
    return [usable](const Eigen::VectorXd&, bool) {
      return ResidualEvaluation{usable, "", Eigen::VectorXd::Constant(4, 3), {}, {}};
    };
  };
  const Calibration found = Calibrate({}, predict_as(true));
  EXPECT_TRUE(found.HasSolution());
  EXPECT_TRUE(found.estimates.empty());
  EXPECT_DOUBLE_EQ(found.rms, 3);
  EXPECT_FALSE(Calibrate({}, predict_as(false)).HasSolution());
}

TEST(Calibration, ReportsAFailedPrediction) {
  const auto fails = [](const Eigen::VectorXd&, bool) {
    return ResidualEvaluation{false, "element 3 is inverted", {}, {}};
  };
  const Calibration found = Calibrate(AmplitudeAndTime(), fails);
  EXPECT_FALSE(found.usable);
  EXPECT_THAT(found.message, testing::HasSubstr("element 3"));
}

}  // namespace
}  // namespace lacuna
