#include "trials/trial_run.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "diagnosis/decision.h"
#include "diagnosis/decision_store.h"
#include "diagnosis/synthetic_space.h"
#include "support/temporary_folder.h"
#include "trials/case_files.h"
#include "trials/follow_up.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// Evidence of a refit and of the first order are not compared with each other.
TEST(RankedTypes, PutsEffectsWithAUsableRefitFirst) {
  const auto ranked = [](const std::string& type, double first_order) {
    RankedEffect effect;
    effect.scored.candidate.type = type;
    effect.scored.score.evidence = first_order;
    return effect;
  };
  std::vector<RankedEffect> effects = {ranked("failed", 900), ranked("untried", 400),
                                       ranked("harmful", 300), ranked("best", 200),
                                       ranked("weak", -5)};
  effects[0].refitted = effects[2].refitted = effects[3].refitted = true;
  effects[0].refit_message = "the fit did not converge";
  effects[2].evidence = -20;
  effects[3].evidence = 150;
  EXPECT_THAT(RankedTypes(effects), ElementsAre("best", "harmful", "failed", "untried", "weak"));
}

TrialCase CaseWithDrag() {
  TrialCase trial =
      DrawCase("0000-one_effect-drag-2x-1rec", TrialGroup::kOneEffect, 5, 1, false, "");
  trial.hidden = {DrawHidden("drag", trial, 7)};
  return trial;
}

TEST(RedecideOutcome, ReplacesAFalsifiedVerdict) {
  const TemporaryFolder folder;
  const SyntheticSpace synthetic(1);
  const DecisionInput input =
      InputOf(synthetic, SyntheticSpace::Noise(18) - 12 * synthetic.Of("drag"));
  const Decision decision = Decide(input);
  ASSERT_FALSE(decision.names.empty());
  TrialOutcome falsified;
  falsified.verdict = Verdict::kNoPower;
  falsified.named = {"pressure"};
  falsified.ranked = {"drag", "mass_damping"};
  falsified.error_before = 1.5;
  falsified.probabilities = {
      {.kind = HypothesisProbability::Kind::kEffect, .names = {"pressure"}, .probability = 1}};
  WriteTrialOutcome(falsified, folder.Path());
  EXPECT_FALSE(RedecideOutcome(CaseWithDrag(), folder.Path())) << "no decision was kept";
  EXPECT_EQ(ReadTrialOutcome(folder.Path()).named, falsified.named);

  WriteDecisionInput(input, folder / kDecisionFolder);
  ASSERT_TRUE(RedecideOutcome(CaseWithDrag(), folder.Path()));
  const TrialOutcome outcome = ReadTrialOutcome(folder.Path());
  EXPECT_EQ(outcome.verdict, decision.verdict);
  EXPECT_EQ(outcome.named, decision.names);
  ASSERT_EQ(outcome.probabilities.size(), decision.record.probabilities.size());
  EXPECT_EQ(outcome.probabilities.front().names, decision.record.probabilities.front().names);
  ASSERT_TRUE(outcome.simulated.has_value());
  EXPECT_THAT(outcome.simulated->truth, ElementsAre("drag"));
  // What does not follow from the decision stays.
  EXPECT_EQ(outcome.ranked, falsified.ranked);
  EXPECT_EQ(outcome.error_before, falsified.error_before);
}

// Of three cases one is open. That its experiment is gone is no result: once the file is back, its
// follow-ups are made.
TEST(RunFollowUps, FollowsOpenCasesAndKeepsWhyOneFailed) {
  const TemporaryFolder folder;
  TrialCase trial = CaseWithDrag();
  const auto keep = [&](const std::string& name, TrialGroup group, Verdict verdict) {
    trial.name = name;
    trial.group = group;
    TrialOutcome outcome;
    outcome.verdict = verdict;
    outcome.named = {"drag"};
    MakeFolder(folder / name);
    WriteCase(trial, folder / name);
    WriteTrialOutcome(outcome, folder / name);
  };
  keep("closed", TrialGroup::kOneEffect, Verdict::kMissing);
  keep("open", TrialGroup::kOneEffect, Verdict::kAdequate);
  keep("removed", TrialGroup::kRemoved, Verdict::kAdequate);
  EXPECT_TRUE(RunFollowUps(folder.Path(), 2));
  EXPECT_FALSE(ReadFollowUps(folder / "open").has_value());
  EXPECT_THAT(FileContent(folder / "open/follow_up" / kFailureFile), HasSubstr(kExperimentFile));
  EXPECT_FALSE(ReadFollowUps(folder / "closed").has_value());
  EXPECT_FALSE(ReadFollowUps(folder / "removed").has_value());
  const FollowUpReport report = ReportFollowUps(folder.Path());
  EXPECT_EQ(report.open, 1);
  EXPECT_EQ(report.waiting, 1);
  EXPECT_EQ(report.unpaired, 0);
}

}  // namespace
}  // namespace lacuna
