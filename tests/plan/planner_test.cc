#include "plan/planner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "plan/planned_bar.h"
#include "report/plan_report.h"
#include "support/silent_progress.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using Kind = HypothesisProbability::Kind;

HypothesisProbability Probable(Kind kind, const std::vector<std::string>& names,
                               double probability) {
  HypothesisProbability one;
  one.kind = kind;
  one.names = names;
  one.probability = probability;
  return one;
}

TEST(RivalsOf, AreTheEffectsAmongTheMostProbableHypotheses) {
  DiagnosisRecord diagnosis;
  diagnosis.decision.probabilities = {
      Probable(Kind::kEffect, {"mass_damping"}, 0.50), Probable(Kind::kEffect, {"drag"}, 0.30),
      Probable(Kind::kNuisance, {"mesh"}, 0.12), Probable(Kind::kPair, {"drag", "gravity"}, 0.05),
      Probable(Kind::kEffect, {"pressure"}, 0.03)};
  const std::vector<PlannedRival> rivals = RivalsOf(diagnosis);
  ASSERT_EQ(rivals.size(), 2u);  // gravity is kept in a pair only
  EXPECT_EQ(rivals[0].effect, "mass_damping");
  EXPECT_EQ(rivals[1].effect, "drag");
  EXPECT_EQ(rivals[1].probability, 0.30);
}

// A nuisance beside an effect is not to be decided upon.
TEST(RivalsOf, AreEffectsWithOrWithoutNuisances) {
  DiagnosisRecord diagnosis;
  diagnosis.decision.probabilities = {
      Probable(Kind::kEffect, {"drag", "clock"}, 0.50), Probable(Kind::kEffect, {"gravity"}, 0.30),
      Probable(Kind::kEffect, {"drag"}, 0.20), Probable(Kind::kNuisance, {"clock"}, 0)};
  const std::vector<PlannedRival> rivals = RivalsOf(diagnosis);
  ASSERT_EQ(rivals.size(), 2u);
  EXPECT_EQ(rivals[0].effect, "drag");
  EXPECT_NEAR(rivals[0].probability, 0.70, 1e-12);
  EXPECT_EQ(rivals[1].effect, "gravity");
}

// Why there is no plan for a diagnosis that has left these hypotheses.
std::string WhyNoPlan(const std::vector<HypothesisProbability>& probabilities) {
  const PlannedBar bar;
  FittedRun fitted;
  fitted.study = bar.study;
  fitted.mesh = bar.mesh;
  DiagnosisRecord diagnosis;
  diagnosis.decision.probabilities = probabilities;
  SilentProgress progress;
  try {
    MakePlan({fitted, diagnosis, {}}, {}, &progress);
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "";
}

TEST(MakePlan, SaysThatNothingIsLeftToBeDecided) {
  // With or without an error of the clock, drag is missing.
  EXPECT_THAT(
      WhyNoPlan({Probable(Kind::kEffect, {"drag", "clock"}, 0.6),
                 Probable(Kind::kEffect, {"drag"}, 0.4), Probable(Kind::kNuisance, {"clock"}, 0)}),
      HasSubstr("has left no rivals"));
}

// A plan for single effects would give both partners the same probability.
TEST(MakePlan, RefusesPairsOfEffects) {
  EXPECT_THAT(WhyNoPlan({Probable(Kind::kPair, {"drag", "gravity"}, 0.7),
                         Probable(Kind::kPair, {"pressure", "drag"}, 0.3)}),
              ::testing::AllOf(HasSubstr("drag with gravity, pressure with drag"),
                               HasSubstr("add drag, which all that it keeps have in common")));
  EXPECT_THAT(WhyNoPlan({Probable(Kind::kPair, {"drag", "gravity"}, 0.6),
                         Probable(Kind::kEffect, {"pressure"}, 0.4)}),
              HasSubstr("add one of them"));
}

TEST(PlanReport, HasNoTableWhereNoRecordingCanBeMade) {
  PlanRecord plan;
  plan.rivals = {{"one", "the first loss", 0.6, 0.01}, {"two", "the second loss", 0.4, 0.01}};
  PlannedOutcome& outcome = plan.outcomes.emplace_back();
  outcome.name = "harder";
  outcome.message = "the bar leaves the room";
  EXPECT_EQ(PlanReport(plan), PlanSummary(plan));
  EXPECT_THAT(PlanReport(plan), HasSubstr("\"harder\" cannot be made: the bar leaves"));
}

// Two recordings of which neither separates the rivals.
TEST(PlanSummary, NamesRivalsThatNoRecordingSeparates) {
  PlanRecord plan;
  plan.rivals = {{"one", "the first loss", 0.6, 0.01}, {"two", "the second loss", 0.4, 0.01}};
  for (const double lambda : {3.25, 1.5}) {
    PlannedOutcome& outcome = plan.outcomes.emplace_back();
    outcome.what = "\"bar\" once more";
    outcome.named = {0.1, 0.2};
    outcome.probability = 0.14;
    outcome.pairs = {{"one", "two", 0.5, lambda}};
  }
  std::string text = PlanSummary(plan);
  std::replace(text.begin(), text.end(), '\n', ' ');
  EXPECT_THAT(text, HasSubstr("None of them tells apart the first loss and the second loss (λ at "
                              "most 3.2); λ = 12 is needed."));
  plan.outcomes.back().pairs[0].lambda_then = 15;
  EXPECT_THAT(PlanSummary(plan), ::testing::Not(HasSubstr("None of them tells")));
}

}  // namespace
}  // namespace lacuna
