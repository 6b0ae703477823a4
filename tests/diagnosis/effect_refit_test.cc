#include "diagnosis/effect_refit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <random>

#include "calibration/calibration_fits.h"
#include "calibration/linear_misfit.h"
#include "diagnosis/projected_hypotheses.h"
#include "diagnosis/rank_effects.h"
#include "effects/catalogue.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr int kMisfitFrames = 40, kSeries = 3;
constexpr double kSigma = 1e-4;  // m

// One recording of one marker, whose residual is `amount` of the nuisance and a wave.
FittedHypothesis MakeHypothesis(double amount) {
  LinearisedMisfit misfit;
  misfit.usable = true;
  LinearisedMisfit::Part part;
  part.layout.series = kSeries;
  part.layout.count.assign(kSeries * kMisfitFrames, 1);
  for (int frame = 0; frame < kMisfitFrames; ++frame) part.layout.times.push_back(0.01 * frame);
  part.errors.noise = kSigma;
  part.fitted.assign(kMisfitFrames, 1);
  const Eigen::Index rows = kSeries * kMisfitFrames;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(rows, 0, 1);
  misfit.jacobian.resize(rows, 2);
  misfit.jacobian.col(0) = 1e-3 * (2 * std::numbers::pi * t).array().cos();
  misfit.jacobian.col(1) = 1e-3 * t;
  misfit.residual = kSigma * (40 * t).array().sin();
  misfit.residual -= amount * misfit.jacobian.col(1);
  misfit.parts.push_back(part);
  FittedHypothesis hypothesis;
  hypothesis.misfit = misfit;
  hypothesis.parameters = 1;
  hypothesis.priors = {{0, 1, false}, {0.1, 0.2, false}};
  hypothesis.residual = misfit.residual;
  return hypothesis;
}

const NoiseLevel kNoise{0.008, 1.3};

// At the best parameters the evidence is that of the linear model; other parameter values have
// less.
TEST(HypothesisEvidence, IsThatOfTheLinearModelAtTheBestParameters) {
  FittedHypothesis hypothesis = MakeHypothesis(0.8);
  const auto fit = [&] {
    const LinearisedMisfit& misfit = hypothesis.misfit;
    return LinearGaussianModel(
               WhitenedRows(misfit.residual, misfit, {.correlation_time = kNoise.correlation_time}),
               WhitenedRows(misfit.jacobian, misfit, {.correlation_time = kNoise.correlation_time}),
               hypothesis.priors)
        .FitAll(kNoise.variance);
  };
  const LinearFit best = fit();
  EXPECT_LT(EvidenceOf(hypothesis, kNoise).log_evidence, best.log_evidence - 1e-6);
  hypothesis.misfit.residual += best.change[0] * hypothesis.misfit.jacobian.col(0);
  hypothesis.priors[0].mean -= best.change[0];
  EXPECT_NEAR(EvidenceOf(hypothesis, kNoise).log_evidence, best.log_evidence, 1e-9);
}

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
  misfit.parts[0].fitted.assign(kMisfitFrames, 0);
  std::fill_n(misfit.parts[0].fitted.begin(), kMisfitFrames / 2, 1);
  const Eigen::Index half = column.size() / 2;
  misfit.residual = -amount * column;
  if (!held_out_agrees) misfit.residual.tail(half).setZero();
  for (double& value : misfit.residual) value += kSigma * normal(*random);
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

// A nuisance explains its part of the residual, at the cost that its prior puts on the amount.
TEST(HypothesisEvidence, CountsTheCostOfTheNuisancesItUses) {
  const FittedHypothesis usual = MakeHypothesis(0.1), far = MakeHypothesis(0.9);
  const HypothesisEvidence of_usual = EvidenceOf(usual, kNoise), of_far = EvidenceOf(far, kNoise);
  EXPECT_LT(of_far.misfit, 1.05 * of_usual.misfit);
  // (0.8 / 0.2)² / 2 = 8, if the data determine the amount.
  EXPECT_NEAR(of_usual.log_evidence - of_far.log_evidence, 8, 0.5);
}

// The Bayes factor of another effect beside a refit is that of the linear models with and without
// its columns; the refitted effect itself is not considered.
TEST(SpaceOfARefit, WeighsTheOtherEffectsBesideIt) {
  FittedHypothesis hypothesis = MakeHypothesis(0.1);
  LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(misfit.residual.size(), 0, 1);
  const Eigen::VectorXd there = 1e-3 * (4 * std::numbers::pi * t).array().sin();
  EffectRanking ranking;
  ranking.tried = {{"refitted", "", there, {{0, 1, false}}},
                   {"absent", "", 1e-3 * (9 * std::numbers::pi * t).array().cos(), {{0, 1, false}}},
                   {"there", "", there, {{0, 1, false}}},
                   {"a nuisance", "", there, {{0, 1, false}}, 0, true}};
  misfit.residual += 0.2 * there;
  const HypothesisSpace space = SpaceOf(hypothesis, ranking, {"refitted"}, kNoise);
  const ProjectedHypotheses projected(space);
  const Eigen::VectorXd factors = projected.FactorsOfResidual();
  ASSERT_EQ(factors.size(), 3);
  const auto evidence = [&] {
    return LinearGaussianModel(
               WhitenedRows(misfit.residual, misfit, {.correlation_time = kNoise.correlation_time}),
               WhitenedRows(misfit.jacobian, misfit, {.correlation_time = kNoise.correlation_time}),
               hypothesis.priors)
        .FitAll(kNoise.variance)
        .log_evidence;
  };
  const double without = evidence();
  misfit.jacobian.conservativeResize(Eigen::NoChange, 3);
  misfit.jacobian.col(2) = there;
  hypothesis.priors.push_back({0, 1, false});
  EXPECT_NEAR(factors[1], evidence() - without, 1e-6 * factors[1]);
  EXPECT_GT(factors[1], 10);
  EXPECT_LT(factors[0], 0);
  EXPECT_NEAR(factors[2], factors[1], 1e-9 * factors[1]);
}

// With the best parameter for all frames, or for the fitted ones.
FittedHypothesis AtItsBest(FittedHypothesis hypothesis, const NoiseLevel& noise, bool fitted_only) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::VectorXd change =
      LinearGaussianModel(
          WhitenedRows(misfit.residual, misfit,
                       {.correlation_time = noise.correlation_time, .fitted_only = fitted_only}),
          WhitenedRows(misfit.jacobian, misfit,
                       {.correlation_time = noise.correlation_time, .fitted_only = fitted_only}),
          hypothesis.priors)
          .FitAll(noise.variance)
          .change;
  hypothesis.misfit.residual += change[0] * hypothesis.misfit.jacobian.col(0);
  hypothesis.priors[0].mean -= change[0];
  return hypothesis;
}

// The evidence of the held-out frames is their predictive density given the fitted ones: a Gaussian
// about the prediction with the best parameter, whose covariance comes from the noise and from the
// remaining uncertainty in the parameter.
TEST(RefitEvidence, OfHeldOutFramesIsTheirPredictiveDensity) {
  const NoiseLevel white{0, 1.3};
  FittedHypothesis with = MakeHypothesis(0.8), without;
  std::fill(with.misfit.parts[0].fitted.begin() + kMisfitFrames / 2,
            with.misfit.parts[0].fitted.end(), 0);
  with.misfit.jacobian = with.misfit.jacobian.col(1).eval();
  with.priors = {{0, 2, false}};
  without = with;
  without.misfit.jacobian.setZero();
  EffectRefit a, b;
  a.at_fit = AtItsBest(with, white, true);
  a.hypothesis = AtItsBest(with, white, false);
  b.at_fit = b.hypothesis = without;
  const RefitEvidence of_a = EvidenceOf(a, white), of_b = EvidenceOf(b, white);
  const double held_out = of_a.held_out - of_b.held_out;

  const Eigen::Index half = kSeries * kMisfitFrames / 2;
  const double variance = 1.3 * kSigma * kSigma;
  const Eigen::VectorXd by = with.misfit.jacobian.col(0), residual = with.misfit.residual;
  const double precision = by.head(half).squaredNorm() / variance + 0.25;
  const double best = -by.head(half).dot(residual.head(half)) / variance / precision;
  const Eigen::VectorXd to_come = by.tail(half);
  const Eigen::MatrixXd covariance =
      variance * Eigen::MatrixXd::Identity(half, half) + to_come * to_come.transpose() / precision;
  const Eigen::VectorXd missed = residual.tail(half) + best * to_come;
  const double log_density = -0.5 * missed.dot(covariance.llt().solve(missed)) -
                             0.5 * std::log((covariance / variance).determinant());
  const double log_without = -0.5 * residual.tail(half).squaredNorm() / variance;
  EXPECT_NEAR(held_out, log_density - log_without, 1e-6 * std::abs(held_out));
  EXPECT_GT(held_out, 100);
  EXPECT_GT(of_a.all - of_b.all, held_out);
}

// The bar that was held aside and released, with elements that are too coarse.
class OfACoarseBar : public ::testing::Test {
 protected:
  OfACoarseBar() {
    WriteBarRecording(folder_.Path(), FilmHeldBar({}));
    study_ = ReadBarStudy(folder_.Path());
    problem_.emplace(study_, BarMesh({6, 2, 2}, 1));
  }

  const TemporaryFolder folder_;
  PredictionStudy study_;
  std::optional<CalibrationProblem> problem_;
  SilentProgress progress_;
};
using EffectRankingOfACoarseBar = OfACoarseBar;

class EffectRefitOfACoarseBar : public OfACoarseBar {
 protected:
  void SetUp() override {
    fit_ = FitFromStart(*problem_, &progress_);
    ASSERT_FALSE(fit_.estimates.empty()) << fit_.message;
    misfit_ = problem_->Linearise(fit_.parameters, {.with_jacobian = true});
    ASSERT_TRUE(misfit_.usable) << misfit_.message;
    none_ = {Eigen::MatrixXd(misfit_.residual.size(), 0), {}, 0};
  }

  ScoredEffect Drag() const {
    ScoredEffect drag;
    drag.candidate = {"drag", "", MakeEffect("drag", {{"coefficient", 1}}), {0}};
    drag.score.size = Eigen::VectorXd::Constant(1, 1);
    drag.expected_values = fit_.parameters;
    return drag;
  }

  Calibration fit_;
  LinearisedMisfit misfit_;
  AdoptedNuisances none_;
};

// A bar that is softer near one end may look like one that is stiffer near the other, so a refit
// starts from both.
TEST_F(EffectRankingOfACoarseBar, KeepsThePlacesWithMoreEvidenceThanTheirNeighbours) {
  const EffectRanking ranking = RankEffects(*problem_, problem_->Start(), &progress_);
  int places = 0;
  for (const ScoredEffect& effect : ranking.effects) {
    double at_most = effect.score.evidence;
    for (const ScoredVariant& other : effect.elsewhere) {
      EXPECT_EQ(other.candidate.type, effect.candidate.type);
      EXPECT_NE(other.candidate.variant, effect.candidate.variant);
      EXPECT_GT(other.candidate.position.line, 0);
      EXPECT_LE(other.score.evidence, at_most);
      at_most = other.score.evidence;
    }
    // Half of the places along the length cannot be better than both of their neighbours.
    EXPECT_LE(effect.elsewhere.size(), 4u) << effect.candidate.type;
    places += static_cast<int>(effect.elsewhere.size());
    if (effect.candidate.type == "fibre_stiffness") {
      EXPECT_TRUE(effect.elsewhere.empty());
    }
  }
  EXPECT_GT(places, 0);
}

// First order may predict a size at which the motion is entirely different, and from which no fit
// would return.
TEST_F(EffectRefitOfACoarseBar, IsNotWorseThanTheModelWithoutTheEffect) {
  ScoredEffect bed;
  bed.candidate = {"elastic_support", "", MakeEffect("elastic_support", {{"modulus", 0}}), {0}};
  bed.score.size = Eigen::VectorXd::Constant(1, 3e6);  // Pa/m: the bar cannot move
  bed.expected_values = fit_.parameters;
  BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress_};
  const EffectRefit refit = Refit({baseline, none_}, &bed);
  ASSERT_TRUE(refit.message.empty()) << refit.message;
  // A refit ends when a step gains less than one standard deviation.
  EXPECT_LE(refit.calibration.rms, 1.05 * fit_.rms);
  EXPECT_LT(refit.calibration.start_rms, 3 * fit_.rms);

  // An unknown error of u = 2 standard deviations of the noise makes the interval √(1 + u²) times
  // as wide, or less where the residual that is left has widened it already. The size must be
  // positive.
  baseline.model_error = 2;
  const ParameterEstimate size = refit.sizes.front();
  const ParameterEstimate wider = Refit({baseline, none_}, &bed).sizes.front();
  const double factor = std::hypot(1, 2 / std::max(1.0, refit.calibration.rms));
  EXPECT_EQ(wider.value, size.value);
  EXPECT_NEAR(wider.high - wider.value, factor * (size.high - size.value), 1e-9 * wider.high);
}

// Columns that were computed along another motion take their part of the residual, and the
// parameters follow. The same columns change little.
TEST_F(EffectRefitOfACoarseBar, IsFittedAnewBesideOtherNuisances) {
  const ScoredEffect drag = Drag();
  const BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress_};
  const EffectRefit refit = Refit({baseline, none_}, &drag);
  ASSERT_TRUE(refit.message.empty()) << refit.message;
  const NoiseLevel white{0, 1};
  const RefitEvidence before = EvidenceOf(refit, white);
  const auto beside = [&](const AdoptedNuisances& nuisances) {
    return RefitFromValues({baseline, nuisances}, &drag, refit.values_at_fit);
  };

  const RefitEvidence same = EvidenceOf(beside(none_), white);
  EXPECT_NEAR(same.all, before.all, 0.01 * before.misfit);

  // A column that explains the residual as it is.
  const AdoptedNuisances errors{refit.hypothesis.misfit.residual, {{-1, 0.01, false}}, 1};
  const EffectRefit explained = beside(errors);
  EXPECT_LT(EvidenceOf(explained, white).misfit, 0.01 * before.misfit);
  EXPECT_GT(EvidenceOf(explained, white).all, before.all + 0.45 * before.misfit);
  EXPECT_EQ(explained.hypothesis.misfit.jacobian.cols(), explained.hypothesis.parameters + 1);
  // A column that pushes the model by one per cent of a parameter, which returns.
  const Eigen::VectorXd pushed =
      0.01 * fit_.parameters[0] * refit.hypothesis.misfit.jacobian.col(0);
  const EffectRefit moved = beside({pushed, {{1, 1e-3, false}}, 1});
  EXPECT_NEAR(EvidenceOf(moved, white).misfit, before.misfit, 0.02 * before.misfit);
  // Values beyond a bound start there.
  Eigen::VectorXd beyond = refit.values_at_fit;
  beyond[refit.baseline_values.size()] = -1;  // the coefficient, which must not be negative
  EXPECT_TRUE(RefitFromValues({baseline, none_}, &drag, beyond).message.empty());
}

// The search is given up after its first steps, as one that another effect has beaten.
TEST_F(EffectRefitOfACoarseBar, SaysWhyItHasNotConverged) {
  const ScoredEffect drag = Drag();
  const BaselineModel baseline{*problem_, fit_.parameters, misfit_, &progress_};
  const ExtendedProblem extended(baseline, &drag, none_);
  Eigen::VectorXd far = extended.problem().Start();
  far.head(2) = fit_.parameters.head(2);
  far[0] *= 30;
  const EffectRefit refit =
      RefitFromValues({baseline, none_}, &drag, far, -std::numeric_limits<double>::infinity());
  EXPECT_TRUE(refit.message.empty()) << refit.message;
  EXPECT_NE(refit.unconverged.find("would not come close enough"), std::string::npos)
      << refit.unconverged;
}

}  // namespace
}  // namespace lacuna
