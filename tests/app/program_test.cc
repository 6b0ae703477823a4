// How the programs end, and what they refuse before they compute anything.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include "app/command_line.h"
#include "scan/recording_writer.h"
#include "support/ended_program.h"
#include "support/small_ledger.h"
#include "support/small_run.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::Not;

Ending Trials(const std::string& arguments) {
  return EndingOf(std::string(LACUNA_TRIALS_PROGRAM) + " " + arguments);
}

TEST(TrialsProgram, UnusableInputGivesTheStatusAndTheFormOfMessageOfLacuna) {
  EXPECT_EQ(Trials("--help").status, 0);
  EXPECT_EQ(Trials("bogus").status, 2);
  EXPECT_EQ(Trials("make").status, 2);
  const Ending absent = Trials("report /nowhere");
  EXPECT_EQ(absent.status, 2);
  EXPECT_THAT(absent.said, HasSubstr("lacuna-trials: /nowhere: there is no such folder"));
}

TEST(TrialsProgram, AnErrorOfTheFileSystemIsAMessage) {
  // File names have at most 255 characters.
  const Ending ending = Trials("report " + std::string(300, 'a'));
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("lacuna-trials: "));
}

TEST(TrialsProgram, RefusesWhatDoesNotFitIntoTheMemoryLimit) {
  const TemporaryFolder folder;
  const Ending ending =
      Trials("--memory-limit 1MB make " + Experiment("trials/hidden_effect.yaml") + " " +
             (folder / "cases").string());
  EXPECT_EQ(ending.status, 1);
  EXPECT_THAT(ending.said, HasSubstr("more than the limit of 1 MB"));
  EXPECT_EQ(Trials("--memory-limit 0 report /nowhere").status, 2);
}

// Whether some case of a suite is being made.
bool IsBegun(const fs::path& cases) {
  if (!fs::is_directory(cases)) return false;
  for (const auto& entry : fs::directory_iterator(cases))
    if (fs::exists(entry.path() / "claimed")) return true;
  return false;
}

TEST(TrialsProgram, CtrlCStopsWithTheStatusOfTheShells) {
  const TemporaryFolder folder;
  const fs::path cases = folder / "cases";
  const std::string suite = Experiment("trials/hidden_effect.yaml");
  const pid_t child = fork();
  if (child == 0) {
    (void)!freopen("/dev/null", "w", stdout);
    (void)!freopen("/dev/null", "w", stderr);
    execl(LACUNA_TRIALS_PROGRAM, LACUNA_TRIALS_PROGRAM, "make", suite.c_str(), cases.c_str(),
          nullptr);
    _exit(127);
  }
  int status = 0;
  pid_t ended = 0;
  while (!IsBegun(cases) && (ended = waitpid(child, &status, WNOHANG)) == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ASSERT_EQ(ended, 0);  // the case takes minutes
  kill(child, SIGINT);
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
}

Ending SimulatedBend(const fs::path& motion, const fs::path& recording) {
  return Lacuna("simulate " + Experiment("scenes/bend.yaml") + " -o " + motion.string() +
                " --recording " + recording.string());
}

// In the second, a person writes about the measurement what the program might have written.
TEST(Simulate, DoesNotReplaceARecordingThatWasNotSimulated) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "mine");
  for (const std::string text :
       {"schema_version: 1\nname: measured\n",
        "# Simulated annealing of the setup was used; measured in May.\nschema_version: 1\n"}) {
    std::ofstream(folder / "mine/recording.yaml") << text;
    const Ending ending = SimulatedBend(folder / "motion", folder / "mine");
    EXPECT_EQ(ending.status, 2) << text;
    EXPECT_THAT(ending.said, HasSubstr("mine: contains recording.yaml, but no recording.yaml that "
                                       "begins with \"# Simulated by Lacuna"));
    EXPECT_EQ(FileContent(folder / "mine/recording.yaml"), text);
    EXPECT_FALSE(fs::exists(folder / "motion"));
  }
}

TEST(Simulate, DoesNotReplaceMeasuredDataThatAreNotDescribedYet) {
  const TemporaryFolder folder;
  fs::create_directories(folder / "mine");
  std::ofstream(folder / "mine/markers.csv") << "time,m1_x,m1_y,m1_z\n";
  const Ending ending = SimulatedBend(folder / "motion", folder / "mine");
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("mine: contains markers.csv"));
  EXPECT_EQ(FileContent(folder / "mine/markers.csv"), "time,m1_x,m1_y,m1_z\n");
  EXPECT_FALSE(fs::exists(folder / "mine/recording.yaml"));
  EXPECT_FALSE(fs::exists(folder / "motion"));
}

// An interruption leaves a folder that the same command accepts. Here the folder of the trajectory
// cannot be made.
TEST(Simulate, MarksTheFolderOfTheRecordingBeforeItWritesAnythingElse) {
  const TemporaryFolder folder;
  std::ofstream(folder / "occupied") << "a file";
  EXPECT_EQ(SimulatedBend(folder / "occupied/motion", folder / "made").status, 2);
  EXPECT_EQ(FileContent(folder / "made/recording.yaml"), "# " + std::string(kSimulated) + "\n");
}

// Even where the recording that an experiment reads was simulated itself.
TEST(Simulate, DoesNotReplaceWhatTheExperimentReads) {
  const TemporaryFolder folder;
  fs::copy(Experiment("recordings/hidden_effect/recording_1"), folder / "seen");
  const std::string text = FileContent(folder / "seen/recording.yaml");
  std::ofstream(folder / "seen/recording.yaml") << "# " << kSimulated << "\n" << text;
  const std::string markers = FileContent(folder / "seen/markers.csv");
  std::ofstream(folder / "e.yaml")
      << "use: " << Experiment("hidden_effect.yaml")
      << "\nrecordings:\n  - {recording: seen, to: 0.12 s, hold: {release: 0.1037 s, force: [0 N, "
         "0 N, 0.05 N], region: {half_space: {point: [71.4274 mm, 0 mm, 0 mm], normal: [1, 0, "
         "0]}}}}\n";
  const Ending ending =
      Lacuna("simulate " + (folder / "e.yaml").string() + " -o " + (folder / "motion").string() +
             " --recording " + (folder / "seen/.").string());
  EXPECT_EQ(ending.status, 2) << ending.said;
  EXPECT_THAT(ending.said, HasSubstr("which the experiment reads"));
  EXPECT_EQ(FileContent(folder / "seen/markers.csv"), markers);
  EXPECT_FALSE(fs::exists(folder / "motion"));
}

// The comparison and the diagnosis of a fit stay in the folder when the run is fitted again.
TEST(Lacuna, ResultsOfAnEarlierFitAreNotPrintedAsThoseOfTheRun) {
  const TemporaryFolder folder;
  const std::string run = folder / "bar";
  CalibrationRecord fit = SmallLedger().models[0].record;
  WriteSmallFit(run, {}, fit);
  WriteSmallComparison(run, {});
  WriteSmallDiagnosis(run, *SmallLedger().models[0].diagnosis);
  EXPECT_THAT(Lacuna("info " + run).said, HasSubstr("missing {drag}"));
  EXPECT_THAT(Lacuna("compare --stored " + run).said, Not(HasSubstr("earlier fit")));

  fit.rms = 7;
  WriteSmallFit(folder / "again", {}, fit);
  for (const char* result : {"comparison", "diagnosis"})
    fs::copy(folder / "bar" / result, folder / "again" / result);
  const std::string again = folder / "again";
  const Ending info = Lacuna("info " + again);
  EXPECT_EQ(info.status, 0) << info.said;
  EXPECT_THAT(info.said, Not(HasSubstr("missing {drag}")));
  EXPECT_THAT(info.said, HasSubstr("`lacuna diagnose " + again + "` makes a new one"));
  const Ending stored = Lacuna("compare --stored " + again);
  EXPECT_EQ(stored.status, 2);
  EXPECT_THAT(stored.said, HasSubstr("`lacuna compare " + again + "` makes a new one"));
}

TEST(Lacuna, InfoSaysWhichCommandReadsAnExperimentOrAScene) {
  for (const auto& [name, kind] : {std::pair("hidden_effect.yaml", "`lacuna fit`"),
                                   std::pair("bend.yaml", "`lacuna reconstruct`"),
                                   std::pair("scenes/bend.yaml", "is a scene")}) {
    const Ending ending = Lacuna("info " + Experiment(name));
    EXPECT_EQ(ending.status, 2) << name;
    EXPECT_THAT(ending.said, HasSubstr(kind));
    EXPECT_THAT(ending.said, HasSubstr("`lacuna validate " + Experiment(name)));
  }
}

TEST(Lacuna, SaysThatAnOptionOfTheProgramStandsBeforeTheCommand) {
  const Ending ending = Lacuna("fit x.yaml --threads 2");
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said,
              HasSubstr("\"--threads\" must come before the command: lacuna --threads 2 fit ..."));
  EXPECT_THAT(Lacuna("fit --threads 2 x.yaml").said, HasSubstr("lacuna --threads 2 fit ..."));
  EXPECT_THAT(Lacuna("fit x.yaml --memory-limit=4GB").said,
              HasSubstr("lacuna --memory-limit=4GB fit ..."));
}

// The page of a run shows a plan after `lacuna report`.
TEST(Lacuna, OnlyACommandThatWritesAReportCanOmitIt) {
  EXPECT_THAT(Lacuna("fit --help").said, HasSubstr("--no-report"));
  EXPECT_THAT(Lacuna("plan --help").said,
              AllOf(HasSubstr("--json"), Not(HasSubstr("--no-report"))));
}

TEST(Lacuna, TheNumbersOfFiguresMayStandBeforeTheirFolder) {
  const TemporaryFolder folder;
  const Ending ending = Lacuna("figures -o " + (folder / "f").string() + " --only 1 /nowhere");
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("/nowhere/figure1.yaml"));
}

TEST(Sweep, PassesTheMemoryLimitOnToTheTasksOfSlurm) {
  const TemporaryFolder folder;
  std::ofstream(folder / "sweep.yaml")
      << "schema_version: 1\nname: fits\ncommand: fit\n"
      << "experiments: " << Experiment("hidden_effect.yaml") << "\n";
  const std::string cases = folder / "cases";
  const Ending plan = Lacuna("sweep plan " + (folder / "sweep.yaml").string() + " " + cases);
  ASSERT_EQ(plan.status, 0) << plan.said;
  std::ofstream(folder / "sbatch") << "#!/bin/sh\necho 17\n";
  chmod((folder / "sbatch").c_str(), 0755);
  const Ending run = EndingOf("PATH=" + folder.Path().string() + ":$PATH " + LACUNA_PROGRAM +
                              " --memory-limit 4GB sweep run " + cases + " --launcher slurm");
  EXPECT_EQ(run.status, 0) << run.said;
  EXPECT_THAT(FileContent(folder / "cases/slurm/job.sh"),
              HasSubstr(" --memory-limit 4000000000 sweep run "));
}

}  // namespace
}  // namespace lacuna
