// Decisions where two effects are missing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "diagnosis/decision.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::Not;
using testing::UnorderedElementsAre;
using Kind = HypothesisProbability::Kind;

TEST(Decide, NamesTwoEffectsThatAreBothMissing) {
  const SyntheticSpace synthetic;
  const Decision decision = Decide(InputOf(
      synthetic, SyntheticSpace::Noise(13) - synthetic.Of("gravity") * Eigen::Vector3d(12, -9, 8) -
                     10 * synthetic.Of("fibres")));
  EXPECT_EQ(decision.verdict, Verdict::kMissing);
  EXPECT_THAT(decision.names, UnorderedElementsAre("gravity", "fibres"));
  EXPECT_TRUE(decision.record.adequacy.is_adequate);
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

// One branch leaves what a second one, with another relaxation time, explains.
TEST(Decide, NamesAnEffectThatIsMissingTwice) {
  for (const char* effect : {"viscoelastic_branch", "stiffness_damping"}) {
    SyntheticSpace synthetic;
    const double unit = 1 / std::sqrt(static_cast<double>(SyntheticSpace::kRows));
    synthetic.Add(HypothesisKind::kEffect, effect, unit * SyntheticSpace::Noise(31));
    const Eigen::VectorXd noise = SyntheticSpace::Noise(13);
    DecisionInput input = InputOf(synthetic, noise - 14 * synthetic.Of(effect));
    const Eigen::VectorXd left = noise - 9 * synthetic.Of(effect);
    input.refits.push_back({effect, 70, synthetic.With(left)});
    const Decision decision = Decide(input);
    const HypothesisProbability& best = decision.record.probabilities.front();
    if (effect == std::string("stiffness_damping")) {  // of which a model has one
      EXPECT_EQ(decision.verdict, Verdict::kNotInLibrary);
      EXPECT_EQ(best.kind, Kind::kEffect);
      continue;
    }
    EXPECT_EQ(decision.verdict, Verdict::kMissing);
    EXPECT_THAT(decision.names, ElementsAre(effect));
    EXPECT_EQ(best.kind, Kind::kPair);
    EXPECT_THAT(best.names, ElementsAre(effect, effect));
    // The fit of both replaces first order; a pair that is fitted in vain is none.
    input.pairs.push_back({effect, effect, 30, synthetic.With(noise)});
    EXPECT_EQ(Decide(input).record.probabilities.front().kind, Kind::kPair);
    input.pairs.front().predicts = false;
    EXPECT_EQ(Decide(input).verdict, Verdict::kNotInLibrary);
  }
}

// What the most probable hypothesis leaves, another one that is kept may explain.
TEST(Decide, FindsNothingUnknownWhereAKeptHypothesisIsEnough) {
  SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(13);
  const Eigen::VectorXd fibres = 8 * synthetic.Of("fibres");
  DecisionInput input =
      InputOf(synthetic, noise - synthetic.Of("gravity") * Eigen::Vector3d(12, -9, 8) - fibres);
  input.refits.push_back({"gravity", 800, synthetic.With(noise - fibres)});
  const auto with_gain = [&](double gain) {
    input.pairs = {{"gravity", "fibres", gain, synthetic.With(noise)}};
    return Decide(input);
  };
  // The pair must gain one per cent of what gravity explains, ln 4 for the choice among effects and
  // more than the difference of the priors: it is kept, but less probable than gravity alone.
  const Decision kept = with_gain(9.5);
  EXPECT_EQ(kept.record.probabilities[0].kind, Kind::kEffect);
  EXPECT_EQ(kept.record.probabilities[1].kind, Kind::kPair);
  EXPECT_GT(kept.record.probabilities[1].probability, 0.05);
  EXPECT_EQ(kept.verdict, Verdict::kMissing);
  EXPECT_THAT(kept.names, ElementsAre("gravity"));
  EXPECT_THAT(kept.record.adequacy.beside, UnorderedElementsAre("gravity", "fibres"));
  // A pair that is not kept does not count.
  const Decision dropped = with_gain(2);
  EXPECT_EQ(dropped.verdict, Verdict::kNotInLibrary);
  EXPECT_THAT(dropped.record.adequacy.beside, ElementsAre("gravity"));
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

}  // namespace
}  // namespace lacuna
