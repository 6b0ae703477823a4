#include "plan/planner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "plan/planned_bar.h"
#include "plan/rivals.h"
#include "report/plan_report.h"
#include "support/silent_progress.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
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
  EXPECT_FALSE(rivals[0].IsPair());
  EXPECT_EQ(rivals[1].effect, "drag");
  EXPECT_THAT(rivals[1].effects, ElementsAre("drag"));
  EXPECT_EQ(rivals[1].probability, 0.30);
  EXPECT_EQ(rivals[2].effect, "drag with gravity");
  EXPECT_THAT(rivals[2].effects, ElementsAre("drag", "gravity"));
  EXPECT_EQ(rivals[2].title, "drag together with gravity");
  EXPECT_EQ(rivals[2].probability, 0.05);
}

// A pair is the same in either order, and with a nuisance beside it.
TEST(RivalsOf, HaveEachPairOnce) {
  DiagnosisRecord diagnosis;
  diagnosis.decision.probabilities = {Probable(Kind::kPair, {"gravity", "drag"}, 0.50),
                                      Probable(Kind::kEffect, {"pressure"}, 0.30),
                                      Probable(Kind::kPair, {"drag", "gravity", "clock"}, 0.20),
                                      Probable(Kind::kNuisance, {"clock"}, 0)};
  const std::vector<PlannedRival> rivals = RivalsOf(diagnosis);
  ASSERT_EQ(rivals.size(), 2u);
  EXPECT_EQ(rivals[0].effect, "drag with gravity");
  EXPECT_NEAR(rivals[0].probability, 0.70, 1e-12);
  EXPECT_EQ(rivals[1].effect, "pressure");
}

// Drag is more probable than either of its rivals, though none of its hypotheses is. Rivals of the
// same probability keep their order.
TEST(RivalsOf, AreSortedByTheirProbabilities) {
  DiagnosisRecord diagnosis;
  diagnosis.decision.probabilities = {
      Probable(Kind::kEffect, {"gravity"}, 0.28), Probable(Kind::kEffect, {"drag", "clock"}, 0.24),
      Probable(Kind::kEffect, {"drag"}, 0.24),    Probable(Kind::kEffect, {"pressure"}, 0.12),
      Probable(Kind::kEffect, {"fibres"}, 0.12),  Probable(Kind::kNuisance, {"clock"}, 0)};
  std::vector<std::string> names;
  for (const PlannedRival& rival : RivalsOf(diagnosis)) names.push_back(rival.effect);
  EXPECT_THAT(names, ElementsAre("drag", "gravity", "pressure", "fibres"));
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

// The diagnosis says that it is missing; the partner shows in a model that has it.
TEST(MakePlan, AsksToAddWhatAllHypothesesContain) {
  EXPECT_THAT(WhyNoPlan({Probable(Kind::kPair, {"drag", "gravity"}, 0.7),
                         Probable(Kind::kPair, {"pressure", "drag"}, 0.3)}),
              ::testing::AllOf(HasSubstr("(drag with gravity, drag with pressure) contain drag"),
                               HasSubstr("add drag to the model first")));
  EXPECT_THAT(WhyNoPlan({Probable(Kind::kPair, {"drag", "gravity"}, 0.7),
                         Probable(Kind::kEffect, {"gravity"}, 0.3)}),
              HasSubstr("add gravity to the model first"));
}

TEST(PlanReport, SaysWhichNuisancesCouldNotBeTried) {
  PlanRecord plan;
  plan.rivals = {{"drag", "drag", 1, 0.5, {"drag"}}};
  for (const char* name : {"pull", "twist", "drop"}) {
    PlannedOutcome& outcome = plan.outcomes.emplace_back();
    outcome.name = name;
    outcome.named = {0.9};
  }
  plan.outcomes[0].untried = plan.outcomes[2].untried = {{"mesh", "no other mesh could be made"}};
  std::string text = PlanReport(plan);
  std::replace(text.begin(), text.end(), '\n', ' ');
  EXPECT_THAT(text, HasSubstr("not tried with \"pull\" and \"drop\": mesh; no other mesh could"));
  plan.outcomes[0].untried = plan.outcomes[2].untried = {};
  EXPECT_THAT(PlanReport(plan), ::testing::Not(HasSubstr("not tried")));
}

TEST(PlanReport, NamesTheSizesOfAPairWithTheirEffects) {
  PlanRecord plan;
  plan.rivals = {{"drag", "drag", 0.6, 0.5, {"drag"}},
                 {"drag with gravity", "drag together with gravity", 0.4, 0, {"drag", "gravity"}}};
  PlannedOutcome& outcome = plan.outcomes.emplace_back();
  outcome.named = {0.9, 0.8};
  outcome.probability = 0.86;
  outcome.sizes = {{"drag", "coefficient", "kg/m^3", 3, 1, 0.5},
                   {"drag with gravity", "drag.coefficient", "kg/m^3", 2, 1, 0.5}};
  const std::string report = PlanReport(plan);
  EXPECT_THAT(report, HasSubstr("  drag.coefficient: 3 ± 0.5 kg/m^3, now ± 1 kg/m^3\n"));
  EXPECT_THAT(report, HasSubstr("  drag.coefficient (drag with gravity): 2 ± 0.5 kg/m^3"));
  std::string text = report;
  std::replace(text.begin(), text.end(), '\n', ' ');
  EXPECT_THAT(text, HasSubstr("two effects at once count as not named"));
}

// Two rivals beside other hypotheses, and a recording that tells them apart.
PlanRecord PlanAfter(const std::string& verdict) {
  PlanRecord plan;
  plan.verdict = verdict;
  plan.no_effect = 0.91;
  plan.rivals = {{"one", "the first loss", 0.6, 0.01, {"one"}, 0.03},
                 {"two", "the second loss", 0.4, 0.01, {"two"}, 0.02}};
  PlannedOutcome& outcome = plan.outcomes.emplace_back();
  outcome.what = "\"bar\" once more";
  outcome.named = {0.9, 0.8};
  outcome.probability = 0.86;
  return plan;
}

std::string OneLine(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

TEST(PlanSummary, SaysThatNothingIsOpenAfterAdequate) {
  PlanRecord plan = PlanAfter("adequate");
  plan.also_left = {{"clock", "the clock", 0.06}};
  const std::string text = OneLine(PlanSummary(plan));
  EXPECT_THAT(text, ::testing::StartsWith(
                        "Nothing is open: the recordings show no missing effect (probability that "
                        "none is missing: 91 %). The plan only tells which recording would best "
                        "show the first loss (3 %) and the second loss (2 %), if one of them were "
                        "there."));
  EXPECT_THAT(text, HasSubstr("The best recording: \"bar\" once more"));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("cannot tell apart")));
  EXPECT_THAT(text, ::testing::Not(HasSubstr("the clock")));
}

TEST(PlanSummary, DoesNotCallAQuestionClosedWhoseLikelierAnswerIsAnEffect) {
  PlanRecord plan = PlanAfter("adequate");
  plan.no_effect = 0.35;
  EXPECT_THAT(
      OneLine(PlanSummary(plan)),
      ::testing::StartsWith("No missing effect can be named with certainty, but one is more "
                            "probable than none (probability that none is missing: 35 %). "
                            "The plan tells which recording would best show"));
}

TEST(PlanSummary, GivesTheProbabilitiesOfTheDiagnosis) {
  EXPECT_THAT(OneLine(PlanSummary(PlanAfter("ambiguous {one, two}"))),
              ::testing::StartsWith("The diagnosis cannot tell apart the first loss (3 %) and the "
                                    "second loss (2 %). If one of them is missing, "));
}

TEST(PlanSummary, SaysFirstThatANuisanceIsMoreProbable) {
  PlanRecord plan = PlanAfter("ambiguous {clock, one}");
  plan.also_left = {{"mesh", "the mesh", 0.02}, {"clock", "the clock", 0.91}};
  std::string text = OneLine(PlanSummary(plan));
  EXPECT_THAT(text, ::testing::StartsWith(
                        "The most probable explanation is the clock (91 %), which is no physical "
                        "effect. A plan does not weigh it: the shares of right names hold only if "
                        "an effect is what is missing. The diagnosis cannot"));
  EXPECT_THAT(text, HasSubstr("could explain it, too (the mesh (2 %))"));
  plan.also_left[1].probability = 0.03;  // no more than the first loss
  text = OneLine(PlanSummary(plan));
  EXPECT_THAT(text, ::testing::StartsWith("The diagnosis cannot"));
  EXPECT_THAT(text, HasSubstr("too (the mesh (2 %), the clock (3 %))"));
}

TEST(PlanReport, HasNoTableWhereNoRecordingCanBeMade) {
  PlanRecord plan;
  plan.rivals = {{"one", "the first loss", 0.6, 0.01, {"one"}},
                 {"two", "the second loss", 0.4, 0.01, {"two"}}};
  PlannedOutcome& outcome = plan.outcomes.emplace_back();
  outcome.name = "harder";
  outcome.message = "the bar leaves the room";
  EXPECT_EQ(PlanReport(plan), PlanSummary(plan));
  EXPECT_THAT(PlanReport(plan), HasSubstr("\"harder\" cannot be made: the bar leaves"));
}

// Two recordings of which neither separates the rivals.
TEST(PlanSummary, NamesRivalsThatNoRecordingSeparates) {
  PlanRecord plan;
  plan.rivals = {{"one", "the first loss", 0.6, 0.01, {"one"}},
                 {"two", "the second loss", 0.4, 0.01, {"two"}}};
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
