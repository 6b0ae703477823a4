#include "trials/trial_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/json_file.h"
#include "support/temporary_folder.h"
#include "trials/case_files.h"
#include "trials/trial_run.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

// A suite of invented cases.
class InventedSuite {
 public:
  void Add(TrialGroup group, const std::vector<std::string>& hidden, Verdict verdict,
           const std::vector<std::string>& named, const std::vector<std::string>& ranked) {
    TrialCase trial =
        DrawCase("case_" + std::to_string(count_++), group, 5, /*recordings=*/1, false, "");
    for (const std::string& type : hidden) trial.hidden.push_back(DrawHidden(type, trial, 7));
    TrialOutcome outcome;
    outcome.verdict = verdict;
    outcome.named = named;
    outcome.ranked = ranked;
    outcome.seconds = 10.0 * count_;
    MakeFolder(Path() / trial.name);
    WriteCase(trial, Path() / trial.name);
    WriteTrialOutcome(outcome, Path() / trial.name);
  }
  std::filesystem::path Path() const { return folder_.Path(); }

 private:
  TemporaryFolder folder_;
  int count_ = 0;
};

TEST(TrialReport, CountsEveryNameOfAVerdictUponAPair) {
  InventedSuite suite;
  const std::vector<std::string> pair = {"gravity", "drag"};
  const auto add = [&](Verdict verdict, const std::vector<std::string>& named,
                       const std::vector<std::string>& ranked) {
    suite.Add(TrialGroup::kPair, pair, verdict, named, ranked);
  };
  add(Verdict::kMissing, {"drag", "gravity"}, {"pressure", "swelling", "drag"});  // all, any order
  add(Verdict::kMissing, {"drag"}, {"drag", "pressure"});                         // in part
  add(Verdict::kMissing, {"gravity", "mass_damping"}, {"gravity", "drag"});       // wrong
  add(Verdict::kMissing, {"mass_damping", "gravity"}, {"pressure", "swelling"});  // wrong
  add(Verdict::kAmbiguous, {"pressure", "drag"}, {"pressure", "swelling"});       // listed
  add(Verdict::kAmbiguous, {"pressure", "swelling"}, {"drag"});                   // ranked
  add(Verdict::kNotInLibrary, {}, {"drag", "gravity"});  // ranked first, but nothing is said
  const TrialReport report = ReportTrials(suite.Path());
  ASSERT_EQ(report.tallies.size(), 1u);
  const TrialTally& tally = report.tallies[0];
  EXPECT_EQ(tally.nameable, 7);
  EXPECT_EQ(tally.pairs, 7);
  EXPECT_EQ(tally.top1, 1);
  EXPECT_EQ(tally.in_part, 1);
  EXPECT_EQ(tally.wrong, 2);
  EXPECT_EQ(tally.top2, 5);  // the first three, and both ambiguous ones
  EXPECT_EQ(tally.ranked_first, 4);
  const std::map<std::string, int> said = {
      {"ambiguous", 2}, {"drag", 2}, {"gravity", 3}, {"mass_damping", 2}, {"not in library", 1}};
  EXPECT_EQ(report.confusion.at("drag + gravity"), said);
}

TEST(TrialReport, ASecondNameThatIsNotHiddenIsWrong) {
  InventedSuite suite;
  const auto add = [&](TrialGroup group, const std::vector<std::string>& hidden,
                       const std::vector<std::string>& named) {
    suite.Add(group, hidden, Verdict::kMissing, named, {"drag", "gravity"});
  };
  add(TrialGroup::kOneEffect, {"drag"}, {"drag", "gravity"});
  add(TrialGroup::kOneEffect, {"drag"}, {"drag"});
  add(TrialGroup::kRemoved, {"drag"}, {"gravity"});
  const TrialReport report = ReportTrials(suite.Path());
  ASSERT_EQ(report.tallies.size(), 2u);  // one effect, removed
  EXPECT_EQ(report.tallies[0].top1, 1);
  EXPECT_EQ(report.tallies[0].in_part, 0);
  EXPECT_EQ(report.tallies[0].wrong, 1);
  EXPECT_EQ(report.tallies[0].top2, 2);
  EXPECT_EQ(report.tallies[0].pairs, 0);
  EXPECT_EQ(report.tallies[1].wrong, 1);
  EXPECT_EQ(report.tallies[1].nameable, 0);
  EXPECT_EQ(report.confusion.at("drag").at("gravity"), 1);
  EXPECT_EQ(report.confusion.at("drag (removed)").at("gravity"), 1);
}

TEST(TrialReport, IsSavedWithTheCasesThatAreNotCounted) {
  InventedSuite suite;
  suite.Add(TrialGroup::kPair, {"gravity", "drag"}, Verdict::kMissing, {"drag"}, {"drag"});
  suite.Add(TrialGroup::kControl, {}, Verdict::kAdequate, {}, {});
  std::filesystem::remove(suite.Path() / "case_1" / kOutcomeFile);
  MakeFolder(suite.Path() / "dust");
  WriteFileAtomically(suite.Path() / "dust" / kSkippedFile, "drag would have to be huge\n");
  const TrialReport report = ReportTrials(suite.Path());
  EXPECT_THAT(report.unfinished, ElementsAre("case_1"));
  EXPECT_THAT(report.skipped, ElementsAre("dust"));
  WriteTrialReport(report, suite.Path());
  EXPECT_EQ(FileContent(suite.Path() / "report.txt"), ReportInWords(report));
  EXPECT_THAT(ReportInWords(report), HasSubstr("cases that could not be made: 1"));
  const nlohmann::json json = ReadJsonFile(suite.Path() / "report.json");
  ASSERT_EQ(json.at("tallies").size(), 1u);
  const nlohmann::json& tally = json.at("tallies").at(0);
  EXPECT_EQ(tally.at("cases"), 1);
  EXPECT_EQ(tally.at("top1"), 0);
  EXPECT_EQ(tally.at("in_part"), 1);
  EXPECT_EQ(tally.at("wrong"), 0);
  EXPECT_EQ(tally.at("top2"), 1);
  EXPECT_EQ(json.at("skipped"), nlohmann::json::array({"dust"}));
  EXPECT_EQ(json.at("unfinished"), nlohmann::json::array({"case_1"}));
  EXPECT_EQ(json.at("median_seconds"), 10);
  EXPECT_EQ(json.at("confusion").at("drag + gravity").at("drag"), 1);
  EXPECT_EQ(json.at("follow_ups").at("open"), 0);
}

}  // namespace
}  // namespace lacuna
