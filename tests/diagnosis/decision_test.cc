#include "diagnosis/decision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "diagnosis/decision_rules.h"
#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::Not;
using testing::UnorderedElementsAre;
using Kind = HypothesisProbability::Kind;

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

}  // namespace
}  // namespace lacuna
