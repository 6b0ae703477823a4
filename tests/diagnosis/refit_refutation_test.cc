// What counts against a refitted effect: it gains too little, or it predicts what was not fitted
// worse than the model without it.
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "diagnosis/effect_refit.h"
#include "diagnosis/made_up_hypothesis.h"

namespace lacuna {
namespace {

TEST(FallsShort, WhereARefitGainsLittleOfThePredictionAndLeavesMoreThanNoise) {
  const double noise = 100, predicted = 50;
  const auto falls_short = [&](double misfit_before, double misfit_after, double gained) {
    return FallsShort({-900, misfit_before}, {-900 + gained, misfit_after}, noise, predicted);
  };
  EXPECT_FALSE(falls_short(300, 200, 30));
  EXPECT_TRUE(falls_short(300, 200, 20));
  EXPECT_FALSE(falls_short(300, 110, 20));  // there is no more to be explained
  // The residual of the model is at the estimated noise, or below.
  EXPECT_TRUE(falls_short(102, 90, 20));
  EXPECT_TRUE(falls_short(90, 80, 20));
  EXPECT_FALSE(falls_short(90, 80, 30));
}

TEST(PredictsWorse, WhereTheHeldOutErrorGrowsByMoreThanNoiseExplains) {
  const auto predicts_worse = [](double with, bool has_held_out) {
    ModelErrors errors;
    errors.has_held_out = has_held_out;
    errors.without_nuisances = with;
    ModelErrors without = errors;
    without.without_nuisances = 2;
    return PredictsWorse(errors, without);
  };
  EXPECT_FALSE(predicts_worse(1, true));
  EXPECT_FALSE(predicts_worse(2.1, true));
  EXPECT_TRUE(predicts_worse(2.4, true));
  EXPECT_FALSE(predicts_worse(2.4, false));
}

// A model that is linear in one amount, which its prior leaves free, or that lacks it (`with`
// false), after a fit to the first half of the frames. The residual is noise and `amount` of the
// column.
EffectRefit MakeRefit(bool with, double amount, bool held_out_agrees, std::mt19937* random) {
  std::normal_distribution<double> normal;
  FittedHypothesis hypothesis = MakeHypothesis(0);
  hypothesis.parameters = 0;
  hypothesis.priors = {{0, with ? 1.0 : 1e-9, false}};
  LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::VectorXd column = misfit.jacobian.col(1);
  misfit.jacobian = column;
  misfit.parts[0].fitted.assign(kMadeUpFrames, 0);
  std::fill_n(misfit.parts[0].fitted.begin(), kMadeUpFrames / 2, 1);
  const Eigen::Index half = column.size() / 2;
  misfit.residual = -amount * column;
  if (!held_out_agrees) misfit.residual.tail(half).setZero();
  for (double& value : misfit.residual) value += kMadeUpNoise * normal(*random);
  EffectRefit refit;
  refit.errors.has_held_out = true;
  refit.at_fit = refit.hypothesis = hypothesis;
  return refit;
}

// An effect that is really missing is refuted by noise in fewer than one recording in 100, whatever
// its size; and an effect that the held-out frames contradict is refuted.
TEST(Predicts, AllowsForChanceButNotForMore) {
  constexpr NoiseLevel kWhite{0, 1};
  constexpr int kTimes = 1000;
  for (const double size : {0.0, 0.1, 0.3, 1.0}) {
    int refuted = 0;
    for (unsigned k = 0; k < kTimes; ++k) {
      std::mt19937 random(k), same(k);
      refuted += !Predicts(MakeRefit(true, size, true, &random),
                           MakeRefit(false, size, true, &same), kWhite);
    }
    EXPECT_LE(refuted, kTimes / 100) << size;
  }
  std::mt19937 random(1), same(1);
  EffectRefit with = MakeRefit(true, 2, false, &random);
  EffectRefit without = MakeRefit(false, 2, false, &same);
  EXPECT_FALSE(Predicts(with, without, kWhite));
  EffectRefit unconverged = with;
  unconverged.unconverged = "the search was ended";
  EXPECT_TRUE(Predicts(unconverged, without, kWhite)) << "other parameters may predict better";
  EXPECT_TRUE(IsContradicted(unconverged, without, kWhite));
  EffectRefit limited = with;
  limited.at_limit = {false, true};
  EXPECT_TRUE(Predicts(limited, without, kWhite)) << "a larger size may predict better";
  limited.at_limit = {false, false};
  EXPECT_FALSE(Predicts(limited, without, kWhite));
  without.errors.has_held_out = false;
  EXPECT_TRUE(Predicts(with, without, kWhite));
}

// Of several comparisons, each allows for a smaller part of the false refutations.
TEST(Predicts, AllowsForMoreChanceInEachOfSeveralTests) {
  std::mt19937 random(1);
  const EffectRefit without = MakeRefit(true, 1, true, &random);
  EffectRefit with = without;
  with.errors.unfitted_squares = 2 * 5;  // ln 100 = 4.6, ln 300 = 5.7
  EXPECT_FALSE(Predicts(with, without, {0, 1}));
  EXPECT_TRUE(Predicts(with, without, {0, 1}, 3));
  with.errors.unfitted_squares = 2 * 6;
  EXPECT_FALSE(Predicts(with, without, {0, 1}, 3));
}

// Recordings that were not fitted have no Jacobian; they count by their residuals, and less where
// errors persist from frame to frame.
TEST(Predicts, CountsRecordingsThatWereNotFitted) {
  std::mt19937 random(1), same(1);
  EffectRefit with = MakeRefit(true, 1, true, &random);
  const EffectRefit without = MakeRefit(false, 1, true, &same);
  const double gain = PredictiveGain(with, without, {0, 2});
  with.errors.unfitted_squares = 100;
  EXPECT_NEAR(PredictiveGain(with, without, {0, 2}), gain - 25, 1e-9);
  const NoiseLevel persistent{0.02, 2};
  EffectRefit alone = with;
  alone.errors.unfitted_squares = 0;
  const double lost =
      PredictiveGain(alone, without, persistent) - PredictiveGain(with, without, persistent);
  EXPECT_GT(lost, 0);
  EXPECT_LT(lost, 12);
}

}  // namespace
}  // namespace lacuna
