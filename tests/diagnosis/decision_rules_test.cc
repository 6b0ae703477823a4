#include "diagnosis/decision_rules.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::UnorderedElementsAre;
using Kind = HypothesisProbability::Kind;

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

}  // namespace
}  // namespace lacuna
