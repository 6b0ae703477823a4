// What a decision says of noise, of single effects and errors of the measurement, and of what is
// in no library.
#include "diagnosis/decision.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
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

// The log Bayes factor of an effect to first order.
double FirstOrder(const DecisionInput& input, const std::string& effect) {
  const HypothesisSpace& space = input.baseline;
  std::vector<int> with = space.base;
  for (const WeighedHypothesis& one : space.hypotheses)
    if (one.name == effect) with.insert(with.end(), one.columns.begin(), one.columns.end());
  return space.model.Fit(with, space.variance).log_evidence -
         space.model.Fit(space.base, space.variance).log_evidence;
}

// What was not refitted keeps the share that the best refit has kept, both less the logarithm of
// the number of effects. The error of the model is subtracted from what is left.
TEST(Decide, ReducesFirstOrderByTheShareThatTheBestRefitHasKept) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(15) - 12 * synthetic.Of("drag") -
                                               7 * synthetic.Of("fibres"));
  input.baseline.model_error = 2;
  input.refits.push_back({"drag", 30, synthetic.With(SyntheticSpace::Noise(15))});
  const double of_four = std::log(4);
  const double drag = FirstOrder(input, "drag") - of_four;
  const double fibres = FirstOrder(input, "fibres") - of_four;
  ASSERT_GT(drag, 40);
  ASSERT_GT(fibres, 5);
  const auto evidence = [&](const std::string& effect) {
    for (const HypothesisProbability& one : Decide(input).record.probabilities)
      if (one.names == std::vector<std::string>{effect}) return one.evidence;
    return std::numeric_limits<double>::quiet_NaN();
  };
  EXPECT_NEAR(evidence("fibres"), fibres * (30 - of_four) / drag - 2, 1e-6);
  EXPECT_NEAR(evidence("drag"), 30 - of_four - 2, 1e-9);
  // A refit that has kept everything, and one that has no evidence, say nothing of the others.
  input.refits.front().evidence = drag + of_four;
  EXPECT_NEAR(evidence("fibres"), fibres - 2, 1e-6);
  input.refits.front().evidence = 0.9 * of_four;
  EXPECT_NEAR(evidence("fibres"), fibres - 2, 1e-6);
}

// The posterior alone is that of the whole decision.
TEST(PosteriorOf, IsThatOfTheDecision) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputOf(synthetic, SyntheticSpace::Noise(15) - 8 * synthetic.Of("drag"));
  input.refits.push_back({"mass_damping", 40, synthetic.With(SyntheticSpace::Noise(15))});
  const std::vector<HypothesisProbability> alone = PosteriorOf(input);
  const std::vector<HypothesisProbability> whole = Decide(input).record.probabilities;
  ASSERT_EQ(alone.size(), whole.size());
  for (size_t k = 0; k < whole.size(); ++k) {
    EXPECT_EQ(alone[k].names, whole[k].names);
    EXPECT_EQ(alone[k].probability, whole[k].probability);
  }
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
  int refuted = 0;
  for (const HypothesisProbability& one : decision.record.probabilities) {
    if (one.kind != Kind::kEffect || !one.Contains("mass_damping")) continue;
    ++refuted;
    EXPECT_TRUE(one.is_refuted);
    EXPECT_EQ(one.probability, 0);
  }
  EXPECT_GT(refuted, 0) << "it is told what was refuted";
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
    return std::numeric_limits<double>::quiet_NaN();
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
