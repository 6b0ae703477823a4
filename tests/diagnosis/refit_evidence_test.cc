// The evidence of a refitted model: for all frames, for the held-out ones, and for what stands
// beside it.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "analysis/normal_distribution.h"
#include "analysis/positive_normal.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/made_up_hypothesis.h"
#include "diagnosis/projected_hypotheses.h"

namespace lacuna {
namespace {

const NoiseLevel kCorrelated{0.008, 1.3};

// At the best parameters the evidence is that of the linear model; other parameter values have
// less.
TEST(HypothesisEvidence, IsThatOfTheLinearModelAtTheBestParameters) {
  FittedHypothesis hypothesis = MakeHypothesis(0.8);
  const LinearFit best = LinearFitOf(hypothesis, kCorrelated);
  EXPECT_LT(EvidenceOf(hypothesis, kCorrelated).log_evidence, best.log_evidence - 1e-6);
  hypothesis.misfit.residual += best.change[0] * hypothesis.misfit.jacobian.col(0);
  hypothesis.priors[0].mean -= best.change[0];
  EXPECT_NEAR(EvidenceOf(hypothesis, kCorrelated).log_evidence, best.log_evidence, 1e-9);
}

// An amount that must be positive has the evidence of the truncated prior, like its rivals that
// were not refitted.
TEST(HypothesisEvidence, HasTheTruncatedPriorOfAPositiveAmount) {
  for (const double amount : {0.01, 0.03, 0.3}) {
    FittedHypothesis hypothesis = MakeHypothesis(0.8);
    hypothesis.misfit.residual = -amount * hypothesis.misfit.jacobian.col(0);
    hypothesis.priors[0] = {0, 1, true};
    const LinearFit best = LinearFitOf(hypothesis, kCorrelated);
    ASSERT_GT(best.change[0], 0);
    hypothesis.misfit.residual += best.change[0] * hypothesis.misfit.jacobian.col(0);
    hypothesis.priors[0] = {-best.change[0], 1, false};
    const double without = EvidenceOf(hypothesis, kCorrelated).log_evidence;
    hypothesis.positive = {0};
    EXPECT_NEAR(EvidenceOf(hypothesis, kCorrelated).log_evidence, best.log_evidence, 1e-9);
    EXPECT_NEAR(best.log_evidence - without, LogTwiceNormal(best.change[0] / best.deviation[0]),
                1e-9);
  }
}

// Of two positive amounts, the probability that both are positive counts.
TEST(HypothesisEvidence, HasTheJointProbabilityOfPositiveAmounts) {
  const double amounts[] = {0.02, 0.04};
  FittedHypothesis hypothesis = MakeHypothesis(0.1);
  LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(misfit.residual.size(), 0, 1);
  misfit.jacobian.conservativeResize(Eigen::NoChange, 3);
  misfit.jacobian.col(2) = misfit.jacobian.col(1);
  misfit.jacobian.col(1) = misfit.jacobian.col(0) + 5e-4 * (7 * t).array().sin().matrix();
  hypothesis.parameters = 2;
  hypothesis.priors = {{-amounts[0], 0.5, false}, {-amounts[1], 2, false}, {0.1, 0.2, false}};
  const double without = EvidenceOf(hypothesis, kCorrelated).log_evidence;
  hypothesis.positive = {0, 1};
  const double with = EvidenceOf(hypothesis, kCorrelated).log_evidence;

  const Eigen::MatrixXd white =
      WhitenedRows(misfit.jacobian, misfit, {.correlation_time = kCorrelated.correlation_time});
  Eigen::Matrix3d information = white.transpose() * white / kCorrelated.variance;
  information.diagonal() += Eigen::Vector3d(4, 0.25, 25);
  const Eigen::Matrix2d covariance = information.inverse().topLeftCorner<2, 2>();
  EXPECT_NEAR(with - without, LogOrthantFactor(Eigen::Vector2d(amounts[0], amounts[1]), covariance),
              1e-9);
  EXPECT_LT(covariance(0, 1), 0) << "the amounts depend on each other";
}

// A nuisance explains its part of the residual, at the cost that its prior puts on the amount.
TEST(HypothesisEvidence, CountsTheCostOfTheNuisancesItUses) {
  const FittedHypothesis usual = MakeHypothesis(0.1), far = MakeHypothesis(0.9);
  const HypothesisEvidence of_usual = EvidenceOf(usual, kCorrelated),
                           of_far = EvidenceOf(far, kCorrelated);
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
  const HypothesisSpace space = SpaceBeside(hypothesis.misfit, hypothesis.misfit.jacobian,
                                            hypothesis.priors, ranking, {"refitted"}, kCorrelated);
  const ProjectedHypotheses projected(space);
  const Eigen::VectorXd factors = projected.FactorsOfResidual();
  ASSERT_EQ(factors.size(), 3);
  const double without = LinearFitOf(hypothesis, kCorrelated).log_evidence;
  misfit.jacobian.conservativeResize(Eigen::NoChange, 3);
  misfit.jacobian.col(2) = there;
  hypothesis.priors.push_back({0, 1, false});
  const double with = LinearFitOf(hypothesis, kCorrelated).log_evidence;
  EXPECT_NEAR(factors[1], with - without, 1e-6 * factors[1]);
  EXPECT_GT(factors[1], 10);
  EXPECT_LT(factors[0], 0);
  EXPECT_NEAR(factors[2], factors[1], 1e-9 * factors[1]);
}

// Beside one base after another, the shared columns give the products of all columns.
TEST(WhitenedHypotheses, GivesTheProductsBesideEachBase) {
  const FittedHypothesis one = MakeHypothesis(0.1);
  FittedHypothesis other = MakeHypothesis(0.7);
  other.misfit.jacobian.col(0) *= 3;
  const Eigen::VectorXd t = Eigen::VectorXd::LinSpaced(one.misfit.residual.size(), 0, 1);
  EffectRanking ranking;
  ranking.tried = {{"a", "", 1e-3 * (3 * t).array().sin(), {{0, 2, true}}},
                   {"refitted", "", 1e-3 * (4 * t).array().sin(), {{0, 1, false}}},
                   {"adopted", "", 1e-3 * (5 * t).array().sin(), {{0, 1, false}}, 0, true, true},
                   {"a nuisance", "", 1e-3 * (6 * t).array().sin(), {{0, 3, false}}, 0.5, true}};
  ranking.unknown_force = 1e-3 * (7 * t).array().sin();
  const WhitenedHypotheses shared(ranking, one.misfit, kCorrelated);
  for (const FittedHypothesis* hypothesis : {&one, &std::as_const(other)}) {
    const LinearisedMisfit& misfit = hypothesis->misfit;
    const HypothesisSpace space =
        shared.Beside(misfit, misfit.jacobian, hypothesis->priors, {"refitted"});
    Eigen::MatrixXd columns(t.size(), 5);
    columns << misfit.jacobian, ranking.tried[0].columns, ranking.tried[3].columns,
        ranking.unknown_force;
    const WhiteningOptions rows{.correlation_time = kCorrelated.correlation_time};
    const Eigen::MatrixXd white = WhitenedRows(columns, misfit, rows);
    const Eigen::VectorXd residual =
        WhitenedRows(misfit.residual, misfit, rows) + 0.1 * white.col(1);  // the mean of its prior
    const Eigen::MatrixXd products = white.transpose() * white;
    const Eigen::VectorXd toward = white.transpose() * residual;
    EXPECT_NEAR(space.model.squares(), residual.squaredNorm(), 1e-9 * residual.squaredNorm());
    EXPECT_LT((space.model.products() - products).norm(), 1e-12 * products.norm());
    EXPECT_LT((space.model.toward() - toward).norm(), 1e-12 * toward.norm());
    ASSERT_EQ(space.hypotheses.size(), 3u);
    EXPECT_EQ(space.hypotheses[1].name, "a nuisance");
    EXPECT_EQ(space.hypotheses[1].columns, std::vector<int>{3});
    EXPECT_EQ(space.hypotheses[1].selection_penalty, 0.5);
    EXPECT_EQ(space.hypotheses[2].kind, HypothesisKind::kUnknownForce);
    EXPECT_EQ(space.base, (std::vector<int>{0, 1}));
    EXPECT_TRUE(space.model.Prior(2).positive);
    EXPECT_EQ(space.model.Prior(3).deviation, 3);
  }
}

// With the best parameter for all frames, or for the fitted ones.
FittedHypothesis AtItsBest(FittedHypothesis hypothesis, const NoiseLevel& noise, bool fitted_only) {
  const Eigen::VectorXd change = LinearFitOf(hypothesis, noise, fitted_only).change;
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
  std::fill(with.misfit.parts[0].fitted.begin() + kMadeUpFrames / 2,
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

  const Eigen::Index half = kMadeUpSeries * kMadeUpFrames / 2;
  const double variance = 1.3 * kMadeUpNoise * kMadeUpNoise;
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

}  // namespace
}  // namespace lacuna
