#include "diagnosis/refits.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "diagnosis/made_up_hypothesis.h"
#include "diagnosis/refitted_ranking.h"
#include "effects/catalogue.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

RankedEffect Ranked(const std::string& type, double evidence) {
  RankedEffect effect;
  effect.scored.candidate.type = type;
  const CatalogueEntry* entry = FindEntry(type);
  Eigen::VectorXd values(static_cast<Eigen::Index>(entry->card->parameters.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k)
    values[k] = entry->card->parameters[static_cast<size_t>(k)].plausible_max;
  effect.scored.candidate.effect = entry->make(values);
  effect.refitted = evidence > 0;
  effect.evidence = evidence;
  return effect;
}

// A member of a family is not named before the others have been refitted, even if first order
// promised nothing of them.
TEST(Refits, TheFamilyOfTheBestEffectMayBeTakenForIt) {
  std::vector<RankedEffect> effects{Ranked("gravity", 2), Ranked("drag", 20), Ranked("pressure", 0),
                                    Ranked("mass_damping", 0)};
  EXPECT_THAT(LookAlikesOfBest(effects), ElementsAre(3));
  effects[1].scored.look_alikes = {"pressure"};
  EXPECT_THAT(LookAlikesOfBest(effects), ElementsAre(2, 3));
  for (RankedEffect& effect : effects) effect.evidence = 0;
  EXPECT_THAT(LookAlikesOfBest(effects), IsEmpty());
}

// A cost of v is one unit of log evidence. The lead is 15, or 30 % of the evidence that is gained.
TEST(Refits, AreHopelessByTheirEvidence) {
  RefittedRanking ranked;
  ranked.effects = {Ranked("drag", 20)};
  ranked.refits.resize(1);
  ranked.refits[0].calibration.cost = 1000;
  ranked.baseline.calibration.cost = 1100;
  EXPECT_DOUBLE_EQ(HopelessCost(ranked, 0, {0, 1}), 1030);
  EXPECT_DOUBLE_EQ(HopelessCost(ranked, 0, {0, 5}), 1075);
  ranked.effects[0].refit_message = "it has failed";
  EXPECT_EQ(HopelessCost(ranked, 0, {0, 5}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(HopelessCost(ranked, std::nullopt, {0, 5}), std::numeric_limits<double>::infinity());
}

// Three effects, and a variant that is one of many.
TEST(Refits, PayForTheirSelectionWhereTheyAreComparedWithFirstOrder) {
  constexpr NoiseLevel kWhite{0, 1};
  EffectRefit refit;
  refit.hypothesis = refit.at_fit = MakeHypothesis(0);
  RefittedRanking ranked;
  ranked.effects = {Ranked("drag", 20), Ranked("gravity", 0), Ranked("pressure", 0)};
  ranked.effects[0].scored.selection_penalty = 2;
  ranked.refits = {refit, {}, {}};
  ranked.baseline_evidence = EvidenceOf(refit, kWhite).all - 20;
  CompareWithBest(kWhite, 0, &ranked);
  ASSERT_TRUE(ranked.best.has_value());
  EXPECT_NEAR(ranked.best->evidence, 20 - std::log(3) - 2, 1e-9);

  ScoredVariant other = ranked.effects[1].scored;
  other.selection_penalty = 2 + 14;
  EXPECT_FALSE(IsFarBehind(ranked, other, refit, kWhite));
  other.selection_penalty = 2 + 16;
  EXPECT_TRUE(IsFarBehind(ranked, other, refit, kWhite));
  EXPECT_FALSE(IsFarBehind(ranked, other, refit, kWhite, 2));

  // One that does not pay for its selection is not better than the model without an effect.
  ranked.best.reset();
  ranked.effects[0].scored.selection_penalty = 19;
  CompareWithBest(kWhite, 0, &ranked);
  EXPECT_FALSE(ranked.best.has_value());
}

}  // namespace
}  // namespace lacuna
