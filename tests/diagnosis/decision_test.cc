#include "diagnosis/decision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "diagnosis/decision_maker.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/decision_store.h"
#include "diagnosis/recording_power.h"
#include "diagnosis/synthetic_space.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::Not;
using testing::UnorderedElementsAre;
using Kind = HypothesisProbability::Kind;

DecisionInput InputOf(const SyntheticSpace& synthetic, const Eigen::VectorXd& residual) {
  DecisionInput input;
  input.baseline = synthetic.With(residual);
  input.families = {{"drag", EffectFamily::kLossOutside},
                    {"mass_damping", EffectFamily::kLossOutside},
                    {"gravity", EffectFamily::kSteadyForce},
                    {"fibres", EffectFamily::kStiffnessDistribution}};
  input.noise_is_known = true;
  return input;
}

HypothesisProbability One(Kind kind, const std::string& name, double evidence,
                          EffectFamily family = EffectFamily::kOther) {
  HypothesisProbability one;
  one.kind = kind;
  if (!name.empty()) one.names = {name};
  one.evidence = evidence;
  one.family = family;
  return one;
}

TEST(DecisionRules, PosteriorIsPriorTimesBayesFactor) {
  std::vector<HypothesisProbability> all = {One(Kind::kNothing, "", 0), One(Kind::kEffect, "a", 2),
                                            One(Kind::kNuisance, "n", 1)};
  SetPosterior(&all);
  const double a = kPriorEffects * std::exp(2), n = kPriorNuisances * std::exp(1);
  EXPECT_EQ(all[0].names, std::vector<std::string>{"a"});
  EXPECT_NEAR(all[0].probability, a / (a + n + kPriorNothing), 1e-12);
  EXPECT_NEAR(all[0].probability + all[1].probability + all[2].probability, 1, 1e-12);
}

TEST(DecisionRules, NamesAMemberAFamilyOrASet) {
  const auto naming = [](std::vector<HypothesisProbability> all) {
    SetPosterior(&all);
    return NameFrom(all);
  };
  const auto loss = EffectFamily::kLossOutside, steady = EffectFamily::kSteadyForce;
  const HypothesisProbability nothing = One(Kind::kNothing, "", 0);
  EXPECT_EQ(
      naming({nothing, One(Kind::kEffect, "a", 20, loss), One(Kind::kEffect, "b", 9, loss)}).level,
      Naming::Level::kCommon);
  const Naming family =
      naming({nothing, One(Kind::kEffect, "a", 20, loss), One(Kind::kEffect, "b", 19, loss),
              One(Kind::kEffect, "c", 5, steady)});
  EXPECT_EQ(family.level, Naming::Level::kFamily);
  EXPECT_THAT(family.kept, ElementsAre(0, 1));
  EXPECT_EQ(
      naming({nothing, One(Kind::kEffect, "a", 20, loss), One(Kind::kEffect, "b", 19, steady)})
          .level,
      Naming::Level::kSet);
  EXPECT_EQ(naming({nothing, One(Kind::kEffect, "a", 2, loss)}).level, Naming::Level::kNothing);
}

TEST(DecisionRules, StatesWhatTheHypothesesHaveInCommon) {
  const auto loss = EffectFamily::kLossOutside, steady = EffectFamily::kSteadyForce;
  HypothesisProbability pair = One(Kind::kPair, "a", 41);
  pair.names.push_back("b");
  std::vector<HypothesisProbability> all = {One(Kind::kNothing, "", 0),
                                            One(Kind::kEffect, "a", 39, loss),
                                            One(Kind::kEffect, "b", 20, steady), pair};
  SetPosterior(&all);
  const Naming naming = NameFrom(all);
  EXPECT_EQ(naming.level, Naming::Level::kCommon);
  EXPECT_EQ(naming.kept.size(), 2u);
  EXPECT_THAT(naming.names, ElementsAre("a"));
}

// A nuisance beside an effect is no rival of another effect.
TEST(DecisionRules, NamesNuisancesOnlyWhereTheyStandAlone) {
  const auto names = [](std::vector<HypothesisProbability> all) {
    SetPosterior(&all);
    return NameFrom(all).names;
  };
  HypothesisProbability beside = One(Kind::kEffect, "a", 40);
  beside.names.push_back("n");
  const HypothesisProbability other = One(Kind::kEffect, "b", 40),
                              nothing = One(Kind::kNothing, "", 0);
  EXPECT_THAT(
      names({nothing, beside, other, One(Kind::kNuisance, "n", 3), One(Kind::kNuisance, "m", 40)}),
      UnorderedElementsAre("a", "b", "m"));
  EXPECT_THAT(names({nothing, beside, One(Kind::kEffect, "a", 39), One(Kind::kNuisance, "n", 3)}),
              ElementsAre("a"));
  // The effect with the nuisance (91 %) and the nuisance alone (9 %) have nothing in common.
  std::vector<HypothesisProbability> rivals = {nothing, beside, One(Kind::kNuisance, "n", 38.4)};
  SetPosterior(&rivals);
  const Naming either = NameFrom(rivals);
  EXPECT_EQ(either.level, Naming::Level::kSet);
  EXPECT_THAT(either.names, ElementsAre("a", "n"));
}

// Of two nuisances of one name, each may stand beside the same effect.
TEST(DecisionRules, AddsTheProbabilitiesOfRepeatedHypotheses) {
  const auto beside = [](std::vector<std::string> names, double evidence) {
    HypothesisProbability one = One(Kind::kEffect, "", evidence);
    one.names = std::move(names);
    return one;
  };
  std::vector<HypothesisProbability> all = {
      One(Kind::kEffect, "b", 10.3), beside({"a", "n", "m"}, 10), beside({"a", "m", "n", "m"}, 10)};
  all.push_back(One(Kind::kNuisance, "a", 3));
  SetPosterior(&all);
  EXPECT_THAT(all[0].names, ElementsAre("b"));
  const double a = all[1].probability + all[2].probability;
  MergeRepeated(&all);
  ASSERT_EQ(all.size(), 3u);
  EXPECT_THAT(all[0].names, UnorderedElementsAre("a", "n", "m"));
  EXPECT_NEAR(all[0].probability, a, 1e-12);
  EXPECT_NEAR(all[0].evidence, 10 + std::log(2), 1e-12);
  EXPECT_THAT(all[1].names, ElementsAre("b"));
}

TEST(Decide, CallsNoiseAdequate) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(11));
  Decision decision = Decide(input);
  EXPECT_EQ(decision.verdict, Verdict::kAdequate);
  EXPECT_THAT(decision.names, testing::IsEmpty());
  EXPECT_EQ(decision.record.probabilities.front().kind, Kind::kNothing);
  input.is_anything_detectable = false;
  EXPECT_EQ(Decide(input).verdict, Verdict::kNoPower);
}

TEST(Decide, NamesAnEffectANuisanceOrTheEffectsOfOneFamily) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(22);
  const Decision gravity =
      Decide(InputOf(synthetic, noise - synthetic.Of("gravity") * Eigen::Vector3d(9, -7, 5)));
  EXPECT_EQ(gravity.verdict, Verdict::kMissing);
  EXPECT_THAT(gravity.names, ElementsAre("gravity"));
  const Decision clock = Decide(InputOf(synthetic, noise - 9 * synthetic.Of("clock")));
  EXPECT_EQ(clock.verdict, Verdict::kNuisance);
  EXPECT_THAT(clock.names, ElementsAre("clock"));
  // λ between drag and mass damping is about (8 · 0.3)² = 6.
  const Decision drag = Decide(InputOf(synthetic, noise - 8 * synthetic.Of("drag")));
  EXPECT_GT(drag.record.FamilyProbability(EffectFamily::kLossOutside), 0.99);
  const SyntheticSpace alike(0.05);
  const Decision either = Decide(InputOf(alike, noise - 8 * alike.Of("drag")));
  EXPECT_EQ(either.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(either.names, UnorderedElementsAre("drag", "mass_damping"));
}

TEST(Decide, NamesTwoEffectsThatAreBothMissing) {
  const SyntheticSpace synthetic;
  const Decision decision = Decide(InputOf(
      synthetic, SyntheticSpace::Noise(13) - synthetic.Of("gravity") * Eigen::Vector3d(12, -9, 8) -
                     10 * synthetic.Of("fibres")));
  EXPECT_EQ(decision.verdict, Verdict::kMissing);
  EXPECT_THAT(decision.names, UnorderedElementsAre("gravity", "fibres"));
  EXPECT_TRUE(decision.record.adequacy.is_adequate);
}

// An effect that explains a part of an unknown force is not named as what is missing.
TEST(Decide, SaysThatSomethingUnknownIsLeft) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(14) - 8 * synthetic.Of("fibres") +
                                               4 * synthetic.unknown.rowwise().sum());
  const Decision decision = Decide(input);
  EXPECT_EQ(decision.verdict, Verdict::kNotInLibrary);
  EXPECT_THAT(decision.names, ElementsAre("fibres"));
  EXPECT_FALSE(decision.record.adequacy.is_adequate);
  // It is no more than the error of a model whose effects have explained a thousand times as much.
  input.explained_misfit = 1e5;
  EXPECT_EQ(Decide(input).verdict, Verdict::kMissing);
  EXPECT_TRUE(Decide(input).record.adequacy.is_tolerated);
}

// What an effect leaves may be an error of the measurement. Then nothing unknown is left, and the
// effect is named, not the error.
TEST(Decide, TakesWhatANuisanceExplainsBesideAnEffectForNothingUnknown) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd residual =
      SyntheticSpace::Noise(15) - 60 * synthetic.Of("fibres") - 15 * synthetic.Of("clock");
  const Decision decision = Decide(InputOf(synthetic, residual));
  EXPECT_EQ(decision.verdict, Verdict::kMissing);
  EXPECT_THAT(decision.names, ElementsAre("fibres"));
  EXPECT_THAT(decision.record.adequacy.beside, ElementsAre("fibres", "clock"));
  EXPECT_TRUE(decision.record.adequacy.is_adequate);
  EXPECT_LT(decision.record.adequacy.rms_over_sigma, 1.1);
  // What neither of them explains is still unknown.
  const Decision unknown =
      Decide(InputOf(synthetic, residual + 12 * synthetic.unknown.rowwise().sum()));
  EXPECT_EQ(unknown.verdict, Verdict::kNotInLibrary);
  EXPECT_FALSE(unknown.record.adequacy.is_adequate);
}

// Beside the effect, the error of a clock explains what is left better than a second effect that
// resembles it. The effect is missing, and the second one is not.
TEST(Decide, WeighsNuisancesBesideAnEffectAgainstFurtherEffects) {
  SyntheticSpace synthetic;
  const Eigen::VectorXd clock = synthetic.Of("clock").col(0);
  synthetic.Add(HypothesisKind::kEffect, "pressure",
                clock + 0.4 * SyntheticSpace::Noise(33) / std::sqrt(SyntheticSpace::kRows));
  const Eigen::VectorXd without = SyntheticSpace::Noise(15) - 60 * synthetic.Of("fibres").col(0);
  const Decision decision = Decide(InputOf(synthetic, without - 12 * clock));
  EXPECT_EQ(decision.verdict, Verdict::kMissing);
  EXPECT_THAT(decision.names, ElementsAre("fibres"));
  const HypothesisProbability& best = decision.record.probabilities.front();
  EXPECT_EQ(best.kind, Kind::kEffect);
  EXPECT_EQ(best.family, EffectFamily::kStiffnessDistribution);
  EXPECT_THAT(best.names, ElementsAre("fibres", "clock"));
  EXPECT_THAT(decision.record.adequacy.beside, ElementsAre("fibres", "clock"));
  EXPECT_TRUE(decision.record.adequacy.is_adequate);
  // The second effect is named where it is the one that is missing.
  EXPECT_THAT(Decide(InputOf(synthetic, without - 12 * synthetic.Of("pressure").col(0))).names,
              UnorderedElementsAre("fibres", "pressure"));
  // Whether or not there is such an error, the effect is missing.
  const Decision either = Decide(
      InputOf(synthetic, SyntheticSpace::Noise(15) - 20 * synthetic.Of("fibres") - 3 * clock));
  EXPECT_EQ(either.verdict, Verdict::kMissing);
  EXPECT_THAT(either.names, ElementsAre("fibres"));
  for (const size_t k : {0u, 1u}) {
    EXPECT_TRUE(either.record.probabilities[k].Contains("fibres"));
    EXPECT_LT(either.record.probabilities[k].probability, kStatedProbability);
  }
  EXPECT_GT(either.record.FamilyProbability(EffectFamily::kStiffnessDistribution),
            kStatedProbability);
}

// The estimate of a pair that was not fitted is kept low. A nuisance that explains less than the
// further effect must not take advantage of that.
TEST(Decide, WeighsANuisanceAgainstAPairOnlyAfterItsFit) {
  SyntheticSpace synthetic;
  const Eigen::VectorXd fibres = synthetic.Of("fibres").col(0);
  synthetic.Add(HypothesisKind::kNuisance, "slip",
                fibres + 0.7 * SyntheticSpace::Noise(34) / std::sqrt(SyntheticSpace::kRows));
  const Eigen::VectorXd noise = SyntheticSpace::Noise(13), left = noise - 10 * fibres;
  DecisionInput input =
      InputOf(synthetic, left - synthetic.Of("gravity") * Eigen::Vector3d(12, -9, 8));
  input.refits.push_back({"gravity", 100, synthetic.With(left)});
  input.refits.push_back({"fibres", 5, synthetic.With(noise)});  // gravity gains nothing beside it
  EXPECT_THAT(Decide(input).record.probabilities.front().names, ElementsAre("gravity"));
  input.pairs.push_back({"gravity", "fibres", 45, synthetic.With(noise)});
  EXPECT_THAT(Decide(input).record.probabilities.front().names, ElementsAre("gravity", "fibres"));
  // The fit may show that first order has overrated the pair.
  input.pairs.front().gain = 10;
  EXPECT_THAT(Decide(input).record.probabilities.front().names, ElementsAre("gravity", "slip"));
}

// The error of the model may look like an error of the measurement, too.
TEST(Decide, CountsTheErrorOfTheModelAgainstNuisances) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(22) - 9 * synthetic.Of("clock"));
  input.baseline.model_error = 20;
  EXPECT_EQ(Decide(input).verdict, Verdict::kNuisance);
  input.baseline.model_error = 50;
  EXPECT_EQ(Decide(input).verdict, Verdict::kAdequate);
}

// A refit replaces the first-order evidence, and its own residual is tested.
TEST(Decide, BelievesARefitMoreThanFirstOrder) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(15);
  DecisionInput input = InputOf(synthetic, noise - 8 * synthetic.Of("drag"));
  input.refits.push_back({"drag", 3, synthetic.With(noise)});
  input.refits.push_back({"mass_damping", 40, synthetic.With(noise)});
  const Decision decision = Decide(input);
  EXPECT_THAT(decision.names, ElementsAre("mass_damping"));
  // The unknown error of the model counts against every effect.
  input.baseline.model_error = 50;
  EXPECT_EQ(Decide(input).verdict, Verdict::kAdequate);
}

// The fit with both effects replaces what first order says of the second one beside the first.
TEST(Decide, BelievesTheRefitOfAPairMoreThanFirstOrder) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(13);
  const Eigen::VectorXd gravity = synthetic.Of("gravity") * Eigen::Vector3d(12, -9, 8);
  const Eigen::VectorXd fibres = 10 * synthetic.Of("fibres");
  // First order leaves a part of the fibres, as where their direction is another one.
  DecisionInput input =
      InputOf(synthetic, noise - gravity - fibres + 2 * synthetic.unknown.rowwise().sum());
  input.refits.push_back(
      {"gravity", 100, synthetic.With(noise - fibres + 2 * synthetic.unknown.rowwise().sum())});
  EXPECT_EQ(Decide(input).verdict, Verdict::kNotInLibrary);
  input.pairs.push_back({"gravity", "fibres", 60, synthetic.With(noise)});
  const Decision both = Decide(input);
  EXPECT_EQ(both.verdict, Verdict::kMissing);
  EXPECT_THAT(both.names, UnorderedElementsAre("gravity", "fibres"));
  // A second effect that gains nothing in the refit is not named, and neither is one that
  // the held-out frames refute.
  input.pairs.front().gain = 1;
  EXPECT_THAT(Decide(input).names, ElementsAre("gravity"));
  input.pairs.front().gain = 60;
  input.pairs.front().predicts = false;
  EXPECT_THAT(Decide(input).names, ElementsAre("gravity"));
}

// Beside the first effect, first order prefers one second effect, and the fits another one.
TEST(Decide, WeighsEveryPairThatWasFitted) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(13);
  const Eigen::VectorXd gravity = synthetic.Of("gravity") * Eigen::Vector3d(12, -9, 8);
  const Eigen::VectorXd drag = 10 * synthetic.Of("drag");
  DecisionInput input = InputOf(synthetic, noise - gravity - drag);
  input.refits.push_back({"gravity", 100, synthetic.With(noise - drag)});
  input.pairs.push_back({"gravity", "drag", 45, synthetic.With(noise)});
  EXPECT_THAT(Decide(input).names, UnorderedElementsAre("gravity", "drag"));
  input.pairs.push_back({"gravity", "mass_damping", 60, synthetic.With(noise)});
  EXPECT_THAT(Decide(input).names, UnorderedElementsAre("gravity", "mass_damping"));
  // A pair is not named if it is refuted itself.
  input.pairs.back().predicts = false;
  EXPECT_THAT(Decide(input).names, UnorderedElementsAre("gravity", "drag"));
  // Another pair may then be the best one to first order.
  input.pairs.erase(input.pairs.begin());
  EXPECT_THAT(Decide(input).names, UnorderedElementsAre("gravity", "drag"));
  // Only what can be fitted is believed.
  input.failed_pairs = {{"drag", "gravity"}};
  EXPECT_THAT(Decide(input).names, Not(UnorderedElementsAre("gravity", "drag")));
}

// If two effects are missing, the model with one of them may predict worse than that without any.
TEST(Decide, NamesAPairOfWhichOneEffectAloneIsRefuted) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(13);
  const Eigen::VectorXd gravity = synthetic.Of("gravity") * Eigen::Vector3d(12, -9, 8);
  const Eigen::VectorXd fibres = 10 * synthetic.Of("fibres");
  DecisionInput input = InputOf(synthetic, noise - gravity - fibres);
  input.refits.push_back({"gravity", 100, synthetic.With(noise - fibres)});
  input.refits.push_back({"fibres", 30, synthetic.With(noise - gravity), /*predicts=*/false});
  const auto pair = UnorderedElementsAre("gravity", "fibres");
  EXPECT_THAT(Decide(input).names, pair);  // to first order
  input.pairs.push_back({"gravity", "fibres", 40, synthetic.With(noise)});
  EXPECT_THAT(Decide(input).names, pair);
  // Whichever of the two was fitted first.
  input.pairs.front() = {"fibres", "gravity", 130, synthetic.With(noise)};
  EXPECT_THAT(Decide(input).names, pair);
  input.pairs.front().predicts = false;
  EXPECT_THAT(Decide(input).names, ElementsAre("gravity"));
  // Before a fit, nothing tells that a second effect would mend the prediction of a refuted one.
  input.pairs.clear();
  for (WeighedRefit& refit : input.refits) refit.predicts = false;
  for (const HypothesisProbability& one : Decide(input).record.probabilities)
    EXPECT_NE(one.kind, Kind::kPair);
}

// A model has one law of elasticity, so that no two of them are missing together.
TEST(Decide, PairsNoTwoElasticityLaws) {
  SyntheticSpace synthetic;
  const double unit = 1 / std::sqrt(static_cast<double>(SyntheticSpace::kRows));
  synthetic.Add(HypothesisKind::kEffect, "neo_hookean", unit * SyntheticSpace::Noise(31));
  synthetic.Add(HypothesisKind::kEffect, "linear", unit * SyntheticSpace::Noise(32));
  const Eigen::VectorXd left = SyntheticSpace::Noise(13) - 10 * synthetic.Of("linear");
  DecisionInput input = InputOf(synthetic, left - 12 * synthetic.Of("neo_hookean"));
  input.refits.push_back({"neo_hookean", 70, synthetic.With(left)});
  const Decision decision = Decide(input);
  EXPECT_THAT(decision.names, ElementsAre("neo_hookean"));
  for (const HypothesisProbability& one : decision.record.probabilities)
    EXPECT_FALSE(one.Contains("neo_hookean") && one.Contains("linear"));
  // A law and another effect may be.
  const Eigen::VectorXd fibres = 10 * synthetic.Of("fibres");
  input.baseline = synthetic.With(left - 12 * synthetic.Of("neo_hookean") - fibres);
  input.refits.front().space = synthetic.With(left - fibres);
  EXPECT_THAT(Decide(input).names, UnorderedElementsAre("neo_hookean", "fibres"));
}

// The second effect of a pair must gain more than the error that the model of the first one may
// have: as much as if the first one had been added, and the model diagnosed again.
TEST(Decide, AsksOfAPairWhatTheNextRoundWouldAskOfItsSecondEffect) {
  const SyntheticSpace synthetic;
  const HypothesisSpace adequate = synthetic.With(SyntheticSpace::Noise(13));
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(13) - 40 * synthetic.Of("fibres"));
  input.refits.push_back({"fibres", 2000, adequate});
  input.pairs.push_back({"fibres", "gravity", 15, adequate});
  EXPECT_THAT(Decide(input).names, ElementsAre("fibres"));
  input.pairs.front().gain = 40;
  EXPECT_THAT(Decide(input).names, UnorderedElementsAre("fibres", "gravity"));
  const std::vector<HypothesisProbability> all = Decide(input).record.probabilities;
  const double alone = 2000 - std::log(4);  // of four effects
  EXPECT_NEAR(all[0].evidence - alone,
              40 - std::log(4) - kToleratedModelError * alone + std::log(2), 1e-9);
  // The order in which the two were fitted makes no difference.
  input.refits.push_back({"gravity", 100, adequate});
  input.pairs.front() = {"gravity", "fibres", 1915, adequate};
  EXPECT_THAT(Decide(input).names, ElementsAre("fibres"));
  input.pairs.front().gain = 1940;
  EXPECT_THAT(Decide(input).names, UnorderedElementsAre("fibres", "gravity"));
}

// An effect that does not lower the error of the held-out frames is not named, alone or in a pair.
TEST(Decide, DoesNotNameARefutedEffect) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(15);
  DecisionInput input = InputOf(synthetic, noise - 8 * synthetic.Of("drag"));
  input.refits.push_back({"mass_damping", 40, synthetic.With(noise), /*predicts=*/false});
  input.refits.push_back({"drag", 30, synthetic.With(noise)});
  const Decision decision = Decide(input);
  EXPECT_THAT(decision.names, ElementsAre("drag"));
  for (const HypothesisProbability& one : decision.record.probabilities) {
    const bool has_it = std::count(one.names.begin(), one.names.end(), "mass_damping") > 0;
    if (has_it && one.kind == Kind::kEffect) {
      EXPECT_TRUE(one.is_refuted);
      EXPECT_EQ(one.probability, 0);
    }
  }
}

// Nuisances in the base compete with effects in their place.
TEST(Decide, WeighsAdoptedNuisancesAgainstEffectsInTheirPlace) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(16));
  input.adopted = {"jitter"};
  input.adopted_evidence = 200;
  EXPECT_EQ(Decide(input).verdict, Verdict::kNuisance);
  EXPECT_THAT(Decide(input).names, ElementsAre("jitter"));
  input.in_place_of_adopted.push_back({"drag", 199, synthetic.With(SyntheticSpace::Noise(16))});
  EXPECT_EQ(Decide(input).verdict, Verdict::kAmbiguous);
  input.in_place_of_adopted.front().evidence = 220;
  EXPECT_THAT(Decide(input).names, ElementsAre("drag"));
  EXPECT_THAT(Decide(input).record.adequacy.beside, ElementsAre("drag"));
  // What the effect leaves without the nuisances counts, not what the nuisances leave.
  input.in_place_of_adopted.front().space =
      synthetic.With(SyntheticSpace::Noise(16) + 4 * synthetic.unknown.rowwise().sum());
  EXPECT_EQ(Decide(input).verdict, Verdict::kNotInLibrary);
}

// An effect beside an adopted nuisance is probable, but the nuisance alone may explain the
// residual.
TEST(Decide, IsAmbiguousBetweenANuisanceAloneAndAnEffectBesideIt) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(16);
  DecisionInput input = InputOf(synthetic, noise);
  input.adopted = {"jitter"};
  input.adopted_evidence = 200;
  input.refits.push_back({"drag", 3.5, synthetic.With(noise)});
  const Decision decision = Decide(input);
  EXPECT_THAT(decision.record.probabilities.front().names, ElementsAre("drag", "jitter"));
  EXPECT_EQ(decision.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(decision.names, ElementsAre("drag", "jitter"));
}

// The clock of one recording was adopted, and that of another one explains what is left.
TEST(Decide, NamesEveryNuisanceOnce) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd residual = SyntheticSpace::Noise(22) - 9 * synthetic.Of("clock");
  DecisionInput input = InputOf(synthetic, residual);
  input.adopted = {"clock"};
  input.adopted_evidence = 200;
  input.refits.push_back({"drag", -3, synthetic.With(residual)});
  const Decision decision = Decide(input);
  EXPECT_EQ(decision.verdict, Verdict::kNuisance);
  EXPECT_THAT(decision.names, ElementsAre("clock"));
  EXPECT_THAT(decision.record.adequacy.beside, ElementsAre("clock"));
  EXPECT_TRUE(decision.record.adequacy.is_adequate);
  const std::vector<HypothesisProbability>& all = decision.record.probabilities;
  double sum = 0;
  for (size_t k = 0; k < all.size(); ++k) {
    sum += all[k].probability;
    EXPECT_LE(std::count(all[k].names.begin(), all[k].names.end(), "clock"), 1);
    for (size_t other = 0; other < k; ++other) EXPECT_FALSE(IsRepeated(all[k], all[other]));
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

// An effect in place of adopted nuisances keeps what its natural value is worth.
TEST(Decide, BelievesANaturalValueInPlaceOfAdoptedNuisances) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(16);
  DecisionInput input = InputOf(synthetic, noise);
  input.adopted = {"jitter"};
  input.adopted_evidence = 200;
  input.in_place_of_adopted.push_back({"gravity", 195, synthetic.With(noise)});
  EXPECT_THAT(Decide(input).names, ElementsAre("jitter"));
  input.natural_value["gravity"] = 10;
  EXPECT_EQ(Decide(input).verdict, Verdict::kMissing);
  EXPECT_THAT(Decide(input).names, ElementsAre("gravity"));
}

// Two rivals that share the nuisance of every model: an effect is missing, not the nuisance.
TEST(Decide, DoesNotTakeASharedNuisanceForWhatIsMissing) {
  const SyntheticSpace alike(0.05);
  DecisionInput input = InputOf(alike, SyntheticSpace::Noise(22) - 8 * alike.Of("drag"));
  input.adopted = {"jitter"};
  input.adopted_evidence = 200;
  const Decision decision = Decide(input);
  EXPECT_EQ(decision.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(decision.names, UnorderedElementsAre("drag", "mass_damping"));
}

// Nuisances of one name, one for each recording or grip, are averaged like the variants of an
// effect. Their order does not matter.
TEST(Decide, AveragesTheNuisancesOfOneName) {
  SyntheticSpace synthetic;
  for (const uint64_t seed : {41u, 42u})
    synthetic.Add(HypothesisKind::kNuisance, "clock",
                  SyntheticSpace::Noise(seed) / std::sqrt(SyntheticSpace::kRows));
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(17));
  const auto evidence = [&] {
    for (const HypothesisProbability& one : Decide(input).record.probabilities)
      if (one.kind == Kind::kNuisance) return one.evidence;
    return 0.0;
  };
  input.nuisances = {{"clock", 30}, {"clock", 12}};
  const double one_order = evidence();
  std::swap(input.nuisances[0], input.nuisances[1]);
  EXPECT_EQ(evidence(), one_order);
  EXPECT_NEAR(one_order, 30 - std::log(3), 1e-6);
  // One that was not refitted counts as well.
  input.nuisances.pop_back();
  input.nuisances.front().evidence = 30;
  EXPECT_NEAR(evidence(), 30 - std::log(3), 1e-9);
}

TEST(NaturalValue, IsBelievedWhereItIsMet) {
  const Eigen::Vector3d narrow = Eigen::Vector3d::Constant(0.3);
  const double met = NaturalValueEvidence({-2.7, 0.2, -9.4}, narrow, 9.8, 9.80665);
  EXPECT_GT(met, 1.5);
  const double missed = NaturalValueEvidence({-2.7, 0.2, -5}, narrow, 9.8, 9.80665);
  EXPECT_NEAR(missed, std::log(0.5), 0.01);
  EXPECT_EQ(NaturalValueEvidence({-2.7, 0.2, -9.4}, {5, 5, 5}, 9.8, 9.80665), 0);
  // Against the integral over the sphere by brute force.
  const Eigen::Vector3d mean(0, 0, 9.6), deviation(0.2, 0.2, 0.3);
  const auto density = [](const Eigen::Vector3d& x, const Eigen::Vector3d& m,
                          const Eigen::Vector3d& s) {
    return std::exp(-0.5 * (x - m).cwiseQuotient(s).squaredNorm()) /
           (s.prod() * std::pow(2 * M_PI, 1.5));
  };
  double sum = 0;
  constexpr int kSteps = 2000;
  for (int i = 0; i < kSteps; ++i) {
    const double z = 1 - 0.01 * (i + 0.5) / kSteps;  // the posterior is narrow about the pole
    for (int j = 0; j < 16; ++j) {
      const double angle = 2 * M_PI * j / 16, r = std::sqrt(1 - z * z);
      sum += density(9.80665 * Eigen::Vector3d(r * std::cos(angle), r * std::sin(angle), z), mean,
                     deviation) *
             0.01 / 2 / kSteps / 16;
    }
  }
  const double factor = sum / density({0, 0, 9.80665}, {0, 0, 0}, Eigen::Vector3d::Constant(9.8));
  EXPECT_NEAR(NaturalValueEvidence(mean, deviation, 9.8, 9.80665), std::log(0.5 + 0.5 * factor),
              0.1);
}

TEST(RecordingPower, SaysWhatTheRecordingsCouldTell) {
  const SyntheticSpace alike(0.05);
  const DecisionInput input =
      InputOf(alike, SyntheticSpace::Noise(17) - 8 * alike.Of("drag") - 10 * alike.Of("fibres"));
  const std::vector<RecordedPower> power = SimulatePower(input, {"drag", "fibres"});
  ASSERT_EQ(power.size(), 3u);
  for (const RecordedPower& one : power)
    EXPECT_NEAR(one.named + one.wrong_member + one.wrong + one.open + one.unknown, 1, 1e-9);
  EXPECT_GT(power[0].named, 0.9);  // nothing
  EXPECT_GT(power[1].open, 0.7);   // drag, or mass damping
  EXPECT_GT(power[2].named, 0.9);  // fibres
  const std::vector<RecordedSeparation> separations =
      Separations(input, {"drag", "mass_damping", "fibres"});
  ASSERT_EQ(separations.size(), 3u);
  EXPECT_LT(separations[0].lambda, 1);
  EXPECT_GT(separations[1].lambda, 12);  // separable in four cases of five
}

// Of an effect that the catalogue lacks it is right to say that something unknown is left.
TEST(RecordingPower, SaysWhetherAnEffectOutsideTheCatalogueWouldBeSeen) {
  const SyntheticSpace synthetic;
  const DecisionInput drag =
      InputOf(synthetic, SyntheticSpace::Noise(17) - 12 * synthetic.Of("drag"));
  const std::optional<RecordedPower> known = PowerToFind(drag, "drag", true);
  ASSERT_TRUE(known);
  EXPECT_GT(known->named, 0.6);
  // Mass damping takes its place.
  const std::optional<RecordedPower> unknown = PowerToFind(drag, "drag", false);
  ASSERT_TRUE(unknown);
  EXPECT_EQ(unknown->named, 0);
  EXPECT_EQ(unknown->most_wrong, "mass_damping");
  EXPECT_GT(unknown->wrong_member, 0.5);
  EXPECT_FALSE(PowerToFind(drag, "pressure", true));  // has no columns
  // Nothing can take the place of fibres.
  const DecisionInput fibres =
      InputOf(synthetic, SyntheticSpace::Noise(17) - 20 * synthetic.Of("fibres"));
  const std::optional<RecordedPower> seen = PowerToFind(fibres, "fibres", false);
  ASSERT_TRUE(seen);
  EXPECT_GT(seen->unknown, 0.8);
}

TEST(DecisionStore, DecidesAgainAsBefore) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(18) - 9 * synthetic.Of("drag"));
  input.refits.push_back({"drag", 30, synthetic.With(SyntheticSpace::Noise(18))});
  input.pairs.push_back({"drag", "fibres", 7, synthetic.With(SyntheticSpace::Noise(20)), false});
  input.failed_pairs = {{"drag", "gravity"}};
  input.nuisances.push_back({"clock", 2});
  input.natural_value["gravity"] = 1.5;
  input.baseline.hypotheses.front().selection_penalty = 0.7;
  input.adopted = {"jitter"};
  input.adopted_evidence = 20;
  input.in_place_of_adopted.push_back({"fibres", 25, synthetic.With(SyntheticSpace::Noise(19))});
  const TemporaryFolder folder;
  SaveDecisionInput(input, folder / "decision");
  const DecisionInput read = LoadDecisionInput(folder / "decision");
  EXPECT_EQ(read.failed_pairs, input.failed_pairs);
  const Decision before = Decide(input), after = Decide(read);
  EXPECT_EQ(after.verdict, before.verdict);
  EXPECT_EQ(after.names, before.names);
  ASSERT_EQ(after.record.probabilities.size(), before.record.probabilities.size());
  for (size_t k = 0; k < before.record.probabilities.size(); ++k)
    EXPECT_EQ(after.record.probabilities[k].probability,
              before.record.probabilities[k].probability);
  EXPECT_EQ(after.record.adequacy.p, before.record.adequacy.p);
  std::filesystem::remove(folder / "decision" / "products_1.npy");
  EXPECT_THROW(LoadDecisionInput(folder / "decision"), InputError);
}

}  // namespace
}  // namespace lacuna
