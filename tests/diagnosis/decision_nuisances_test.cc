// Decisions about an effect and an error of the measurement (nuisance) beside it: one that is still
// to be found, and one that was adopted into the model before.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "diagnosis/decision.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;
using Kind = HypothesisProbability::Kind;

// The input of a decision before which this nuisance was adopted, with plain evidence.
DecisionInput InputWithAdopted(const SyntheticSpace& synthetic, const Eigen::VectorXd& residual,
                               const std::string& nuisance) {
  DecisionInput input = InputOf(synthetic, residual);
  input.adopted = {nuisance};
  input.adopted_evidence = 200;
  return input;
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

// Whether a nuisance is already part of the base does not change its prior: alone it has that of
// one nuisance, and beside an effect the product of both.
TEST(Decide, GivesAnAdoptedNuisanceThePriorOfANuisance) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(16);
  DecisionInput input = InputWithAdopted(synthetic, noise, "jitter");
  input.adopted_evidence = 1;
  input.refits.push_back({"drag", 3, synthetic.With(noise)});
  const std::vector<HypothesisProbability> all = Decide(input).record.probabilities;
  const auto probability = [&](const std::vector<std::string>& names) {
    for (const HypothesisProbability& one : all)
      if (one.names == names) return one.probability;
    return std::numeric_limits<double>::quiet_NaN();
  };
  const double nothing = probability({});
  EXPECT_NEAR(probability({"jitter"}) / nothing, 0.15 / 0.5 * std::exp(1), 1e-9);
  EXPECT_NEAR(probability({"drag", "jitter"}) / nothing, 0.3 * 0.15 / 0.5 * std::exp(1 + 3) / 4,
              1e-9);
}

// Nuisances in the base compete with effects in their place.
TEST(Decide, WeighsAdoptedNuisancesAgainstEffectsInTheirPlace) {
  const SyntheticSpace synthetic;
  DecisionInput input = InputWithAdopted(synthetic, SyntheticSpace::Noise(16), "jitter");
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
  DecisionInput input = InputWithAdopted(synthetic, noise, "jitter");
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
  DecisionInput input = InputWithAdopted(synthetic, residual, "clock");
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
    for (size_t other = 0; other < k; ++other)
      EXPECT_FALSE(all[k].kind == all[other].kind &&
                   std::set(all[k].names.begin(), all[k].names.end()) ==
                       std::set(all[other].names.begin(), all[other].names.end()));
  }
  EXPECT_NEAR(sum, 1, 1e-12);
}

// An effect in place of adopted nuisances keeps what its natural value is worth.
TEST(Decide, BelievesANaturalValueInPlaceOfAdoptedNuisances) {
  const SyntheticSpace synthetic;
  const Eigen::VectorXd noise = SyntheticSpace::Noise(16);
  DecisionInput input = InputWithAdopted(synthetic, noise, "jitter");
  input.in_place_of_adopted.push_back({"gravity", 195, synthetic.With(noise)});
  EXPECT_THAT(Decide(input).names, ElementsAre("jitter"));
  input.natural_value["gravity"] = 10;
  EXPECT_EQ(Decide(input).verdict, Verdict::kMissing);
  EXPECT_THAT(Decide(input).names, ElementsAre("gravity"));
}

// Two rivals that share the nuisance of every model: an effect is missing, not the nuisance.
TEST(Decide, DoesNotTakeASharedNuisanceForWhatIsMissing) {
  const SyntheticSpace alike(0.05);
  DecisionInput input =
      InputWithAdopted(alike, SyntheticSpace::Noise(22) - 8 * alike.Of("drag"), "jitter");
  const Decision decision = Decide(input);
  EXPECT_EQ(decision.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(decision.names, UnorderedElementsAre("drag", "mass_damping"));
}

}  // namespace
}  // namespace lacuna
