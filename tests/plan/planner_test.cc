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
  ASSERT_EQ(rivals.size(), 3u);
  EXPECT_EQ(rivals[0].effect, "mass_damping");
  EXPECT_EQ(rivals[1].effect, "drag");
  EXPECT_EQ(rivals[1].probability, 0.30);
  EXPECT_EQ(rivals[2].effect, "gravity");  // of the pair, without a probability of its own
  EXPECT_EQ(rivals[2].probability, 0);
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

TEST(MakePlan, SaysThatNothingIsLeftToBeDecided) {
  const PlannedBar bar;
  FittedRun fitted;
  fitted.study = bar.study;
  fitted.mesh = bar.mesh;
  DiagnosisRecord diagnosis;
  // With or without an error of the clock, drag is missing.
  diagnosis.decision.probabilities = {Probable(Kind::kEffect, {"drag", "clock"}, 0.6),
                                      Probable(Kind::kEffect, {"drag"}, 0.4),
                                      Probable(Kind::kNuisance, {"clock"}, 0)};
  SilentProgress progress;
  try {
    MakePlan({fitted, diagnosis, {}}, {}, &progress);
    ADD_FAILURE() << "a plan without rivals";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("has left no rivals"));
  }
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
  EXPECT_FALSE(plan.IsSeparable());
  std::string text = PlanSummary(plan);
  std::replace(text.begin(), text.end(), '\n', ' ');
  EXPECT_THAT(text, HasSubstr("None of them tells apart the first loss and the second loss (λ at "
                              "most 3.2); λ = 12 is needed."));
  plan.outcomes.back().pairs[0].lambda_then = 15;
  EXPECT_TRUE(plan.IsSeparable());
  EXPECT_THAT(PlanSummary(plan), ::testing::Not(HasSubstr("None of them tells")));
}

}  // namespace
}  // namespace lacuna
