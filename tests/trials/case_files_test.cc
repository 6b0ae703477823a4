#include "trials/case_files.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/claim.h"
#include "core/error.h"
#include "support/temporary_folder.h"
#include "trials/trial_case.h"
#include "trials/trial_run.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// Of 20 controls followed by 20 cases with an effect, the first ten in the order of work are
// neither all of one kind nor others when the suite stands in another folder.
TEST(WorkOn, TakesTheCasesInAnOrderThatIsAFairSample) {
  std::vector<fs::path> cases, moved;
  for (int k = 0; k < 40; ++k) {
    const std::string name = fmt::format("{:04}-{}", k, k < 20 ? "control" : "one_effect");
    cases.push_back(fs::path("suite") / name);
    moved.push_back(fs::path("elsewhere") / name);
  }
  const std::vector<size_t> order = WorkOrder(cases);
  EXPECT_EQ(WorkOrder(moved), order);
  std::vector<size_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (size_t k = 0; k < 40; ++k) EXPECT_EQ(sorted.at(k), k);
  const auto controls =
      std::count_if(order.begin(), order.begin() + 10, [](size_t k) { return k < 20; });
  EXPECT_GE(controls, 2);
  EXPECT_LE(controls, 8);
}

TEST(WorkOn, KeepsTheReasonOfAFailureUntilThereIsAResult) {
  const TemporaryFolder folder;
  const std::vector<fs::path> cases = {folder / "made", folder / "refused", folder / "thrown"};
  // The results stand in a folder of their own, as those of follow-ups do.
  const auto work = [&](bool fails) {
    return WorkOn(cases, "next/result", 2, [&](size_t k) {
      if (fails && k == 1) throw InputError("the mesh is empty");
      if (fails && k == 2) throw std::runtime_error("out of luck");
      std::ofstream(cases[k] / "next/result", std::ios::app) << "made";
    });
  };
  EXPECT_FALSE(work(true));
  EXPECT_EQ(FileContent(cases[0] / "next/result"), "made");
  EXPECT_FALSE(fs::exists(cases[0] / "next/failed.txt"));
  EXPECT_EQ(FileContent(cases[1] / "next/failed.txt"), "the mesh is empty\n");
  EXPECT_THAT(FileContent(cases[2] / "next/failed.txt"), HasSubstr("its process ended"));
  // As a call leaves it that is killed between the result and the removal.
  std::ofstream(cases[0] / "next/failed.txt") << "an earlier reason\n";
  EXPECT_TRUE(work(false));
  for (const fs::path& own : cases) {
    EXPECT_EQ(FileContent(own / "next/result"), "made") << "once, and no more";
    EXPECT_FALSE(fs::exists(own / "next/failed.txt")) << own;
  }
}

TEST(WorkOn, AnInputErrorAloneIsNoFailureOfAProcess) {
  const TemporaryFolder folder;
  EXPECT_TRUE(WorkOn({folder.Path()}, kOutcomeFile, 1, [](size_t) { throw InputError("no"); }));
  EXPECT_EQ(FileContent(folder / kFailureFile), "no\n");
}

TEST(WorkOn, LeavesACaseToTheProcessThatHasClaimedIt) {
  const TemporaryFolder folder;
  const Claim claim(folder / kClaimFile);
  ASSERT_TRUE(claim.holds());
  EXPECT_TRUE(WorkOn({folder.Path()}, kOutcomeFile, 1,
                     [&](size_t) { std::ofstream(folder / kOutcomeFile) << "made"; }));
  EXPECT_FALSE(fs::exists(folder / kOutcomeFile));
}

TEST(TrialGroup, AnUnknownNameIsRefusedWithTheFile) {
  const TemporaryFolder folder;
  std::string text = TextOfCase(DrawCase("x", TrialGroup::kHardControl, 5, 1, false, ""));
  const size_t at = text.find("\"hard_control\"");
  ASSERT_NE(at, std::string::npos);
  std::ofstream(folder / kTruthFile) << text;
  EXPECT_EQ(ReadCase(folder.Path()).group, TrialGroup::kHardControl);
  std::ofstream(folder / kTruthFile) << text.replace(at, 14, "\"hard\"");
  EXPECT_THAT(
      [&] { ReadCase(folder.Path()); },
      ThrowsMessage<InputError>(AllOf(HasSubstr("truth.json"), HasSubstr("\"hard\" is not"))));
}

// The names of the cases of the suite contain that of their group: 0006-hard_control-grip-1rec.
TEST(ReportedSuite, CanStillBeRead) {
  int cases = 0;
  for (const fs::path& own :
       CasesIn(fs::path(LACUNA_SOURCE_DIR) / "results" / "fresh_301130_cases")) {
    const TrialCase trial = ReadCase(own);
    EXPECT_EQ(trial.name, own.filename());
    EXPECT_EQ(trial.name.find("-" + TrialGroupName(trial.group) + "-"), 4u) << own;
    EXPECT_FALSE(VerdictName(ReadTrialOutcome(own).verdict).empty()) << own;
    ++cases;
  }
  EXPECT_GT(cases, 100);
}

}  // namespace
}  // namespace lacuna
