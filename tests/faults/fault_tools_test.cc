// The tools of the faults: counts that can be resumed, folders that are compared, small disks.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "faults/counts.h"
#include "faults/faults.h"
#include "faults/folder_content.h"
#include "faults/process.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

TEST(FaultCounts, WhatWasTriedIsKnownAfterARestart) {
  const TemporaryFolder folder;
  const fs::path file = folder / "counts.jsonl";
  {
    FaultCounts counts(file, "program 1");
    EXPECT_EQ(counts.Find("kill 1"), nullptr);
    counts.Append("kill 1", {.failure = "a differs", .hidden_at_fault = 3});
  }
  std::ofstream(file, std::ios::app) << R"({"trial":"kill 2","fai)";  // killed while it wrote
  {
    FaultCounts counts(file, "program 1");
    ASSERT_NE(counts.Find("kill 1"), nullptr);
    EXPECT_EQ(counts.Find("kill 1")->failure, "a differs");
    EXPECT_EQ(counts.Find("kill 1")->hidden_at_fault, 3);
    EXPECT_EQ(counts.Find("kill 2"), nullptr);
    counts.Append("kill 2", {});
  }
  EXPECT_NE(FaultCounts(file, "program 1").Find("kill 2"), nullptr);
  EXPECT_THAT([&] { FaultCounts(file, "program 2"); },
              ThrowsMessage<InputError>(HasSubstr("another program")));
}

TEST(TryFaults, RefusesAFolderOfOtherFiles) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "fit");
  std::ofstream(folder / "fit/thesis.txt") << "1";
  FaultOptions options;
  options.program = "/bin/sh";
  options.folder = folder.Path();
  Subject fit;
  fit.name = "fit";
  EXPECT_THAT([&] { TryFaults(fit, options); },
              ThrowsMessage<InputError>(HasSubstr("is not empty and holds no counts.jsonl")));
  EXPECT_TRUE(fs::exists(folder / "fit/thesis.txt"));
}

TEST(FolderContent, TimesAndLocksDoNotCountAndEverythingElseDoes) {
  const auto json = [](const char* text) { return WithoutTimes(text, "a.json"); };
  EXPECT_EQ(json("{\"seconds\": 0.5, \"a_seconds\":2e-3, \"nodes\": 7}"),
            json("{\"seconds\": 12, \"a_seconds\":3, \"nodes\": 7}"));
  EXPECT_NE(json("{\"seconds\": 0.5, \"nodes\": 7}"), json("{\"seconds\": 0.5, \"nodes\": 8}"));
  const auto table = [](const char* text) { return WithoutTimes(text, "a/table1.txt"); };
  EXPECT_EQ(table("  49  6 (0)  0.06\n"), table("  49  6 (0) 12.50\n"));
  EXPECT_NE(table("  49  6 (0)  0.06\n"), table("  50  6 (0)  0.06\n"));
  EXPECT_NE(json("  49  6 (0)  0.06\n"), json("  49  6 (0) 12.50\n"));
  const TemporaryFolder folder;
  std::ofstream(folder / "a.txt") << "1";
  std::ofstream(folder / ".lock") << "process 1";
  const auto before = ContentOf(folder.Path());
  std::ofstream(folder / ".lock") << "process 2";
  EXPECT_EQ(Difference(before, ContentOf(folder.Path())), "");
  EXPECT_EQ(CountHidden(folder.Path()), 0);
  std::ofstream(folder / ".a.txt.12.0.tmp") << "1";
  EXPECT_EQ(Difference(before, ContentOf(folder.Path())), ".a.txt.12.0.tmp is left over");
  EXPECT_EQ(CountHidden(folder.Path()), 1);
}

TEST(FaultProcess, AKillReachesWhatTheProcessHasStarted) {
  const TemporaryFolder folder;
  const fs::path file = folder / "late";
  {
    Process process("/bin/sh", {"-c", "(sleep 1; touch late) & sleep 60"}, folder.Path(),
                    folder / "log.txt");
    EXPECT_FALSE(process.EndsWithin(Seconds(0.2)));
    process.Kill();
    EXPECT_EQ(process.Wait(), -1);
  }
  Process("/bin/sh", {"-c", "sleep 1.5"}, folder.Path(), folder / "log.txt").Wait();
  EXPECT_FALSE(fs::exists(file));
}

TEST(FaultProcess, ASmallDiskIsFullWhereItsBytesEnd) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "place");
  if (const std::string problem = SmallDiskProblem(folder / "place"); !problem.empty())
    GTEST_SKIP() << problem;
  const auto run = [&](uint64_t bytes) {
    const SmallDisk disk{bytes, folder / "place", folder / "absent", folder / "left"};
    return Process("/bin/sh", {"-c", "head -c 20000 /dev/zero > place/a"}, folder.Path(),
                   folder / "log.txt", {.disk = disk})
        .Wait();
  };
  // 20 000 bytes are five pages of 4096.
  EXPECT_NE(run(4 * 4096), 0);
  EXPECT_LT(fs::file_size(folder / "left/a"), 20'000u);
  EXPECT_THAT(FileContent(folder / "log.txt"), HasSubstr("space"));
  EXPECT_EQ(run(5 * 4096), 0);
  EXPECT_EQ(fs::file_size(folder / "left/a"), 20'000u);
  EXPECT_TRUE(fs::is_empty(folder / "place"));  // nobody else has seen the disk
}

}  // namespace
}  // namespace lacuna
