#include "record/run_directory.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <csignal>
#include <fstream>
#include <latch>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/interrupt.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using std::chrono::steady_clock;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::ThrowsMessage;
using Status = StageCheck::Status;

std::function<void(const fs::path&)> WriteResult(const std::string& content) {
  return [content](const fs::path& folder) {
    WriteFileAtomically(folder / "result.txt", content);
    fs::create_directory(folder / "frames");
    WriteFileAtomically(folder / "frames" / "000.txt", content + " of frame 0");
  };
}

// Runs `body` in a process of its own, which is then killed without clean-up.
void InKilledProcess(const std::function<void()>& body) {
  const pid_t child = fork();
  if (child == 0) {
    body();
    raise(SIGKILL);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFSIGNALED(status)) << "ended by itself with " << WEXITSTATUS(status);
}

class RunDirectoryTest : public ::testing::Test {
 protected:
  // Creates a run with the stages `surface` and `fit`.
  void MakeFinishedRun() {
    RunDirectory run(folder_);
    run.Begin({{"density", 1070.0}}, {{"scan.ply", "00"}}, 7);
    run.Store("surface", "key s", WriteResult("surface"));
    run.Store("fit", "key f", WriteResult("fit"));
    run.Finish();
  }
  bool HasPartialFolder() const {
    for (const auto& entry : fs::directory_iterator(folder_)) {
      if (entry.path().extension() == ".partial") return true;
    }
    return false;
  }

  const TemporaryFolder parent_;
  const fs::path folder_ = parent_ / "some/run";
};

TEST_F(RunDirectoryTest, StoredStageIsFoundAgainUnderItsKeyOnly) {
  MakeFinishedRun();
  RunDirectory run(folder_);
  EXPECT_TRUE(run.Has("surface", "key s"));
  EXPECT_EQ(run.Check("surface", "another key").status, Status::kOtherKey);
  EXPECT_EQ(run.Check("mesh", "key s").status, Status::kAbsent);
  EXPECT_EQ(FileContent(run.StageFolder("surface") / "frames" / "000.txt"), "surface of frame 0");
}

TEST_F(RunDirectoryTest, ManifestContainsConfigurationInputsSeedAndVersions) {
  MakeFinishedRun();
  const Manifest manifest = ReadManifest(folder_ / "manifest.json");
  EXPECT_EQ(manifest.configuration["density"], 1070.0);
  EXPECT_EQ(manifest.inputs.at("scan.ply"), "00");
  EXPECT_EQ(manifest.seed, 7u);
  EXPECT_FALSE(manifest.program_version.empty());
  EXPECT_EQ(manifest.library_versions.at("Eigen"), "3.4.0");
  EXPECT_TRUE(manifest.library_versions.contains("SuiteSparse"));
  EXPECT_EQ(manifest.stages.at("fit").files.size(), 2u);
  EXPECT_TRUE(manifest.finished);
}

TEST_F(RunDirectoryTest, SameRunElsewhereWritesTheSameManifest) {
  MakeFinishedRun();
  const std::string first = FileContent(folder_ / "manifest.json");
  fs::remove_all(folder_);
  MakeFinishedRun();
  EXPECT_EQ(FileContent(folder_ / "manifest.json"), first);
}

TEST_F(RunDirectoryTest, EachKindOfDamageIsDetectedAndReported) {
  const auto damaged = [this](const std::function<void(const fs::path&)>& damage) {
    fs::remove_all(folder_);
    MakeFinishedRun();
    damage(folder_ / "fit" / "result.txt");
    RunDirectory run(folder_);
    EXPECT_TRUE(run.Has("surface", "key s"));
    const StageCheck check = run.Check("fit", "key f");
    EXPECT_EQ(check.status, Status::kDamaged);
    EXPECT_THAT(check.message, HasSubstr("result.txt"));
    EXPECT_THAT([this] { FinishedStage(folder_, "fit"); },
                ThrowsMessage<InputError>(HasSubstr("is damaged")));
  };
  damaged([](const fs::path& file) { std::ofstream(file) << "fiT"; });
  damaged([](const fs::path& file) { fs::resize_file(file, 1); });
  damaged([](const fs::path& file) { fs::remove(file); });
}

TEST_F(RunDirectoryTest, DamagedStageIsReplacedByStoringItAgain) {
  MakeFinishedRun();
  fs::remove(folder_ / "fit" / "result.txt");
  RunDirectory run(folder_);
  run.Store("fit", "key f", WriteResult("fit"));
  EXPECT_TRUE(run.Has("fit", "key f"));
}

TEST_F(RunDirectoryTest, InputsThatChangeMeanwhileStoreNothing) {
  MakeFinishedRun();
  const fs::path scan = parent_ / "scan.ply";
  std::ofstream(scan) << "old";
  InputFiles inputs;
  inputs.Add("scan.ply", StateOf(scan));
  RunDirectory run(folder_);
  run.Begin({}, inputs.hashes(), 0);
  run.Watch(inputs);
  run.Store("surface", "key s", WriteResult("surface"));
  std::ofstream(scan) << "newer";
  const auto names_it = ThrowsMessage<InputError>(AllOf(
      HasSubstr(scan.string()), HasSubstr("has changed"), HasSubstr("run the command again")));
  EXPECT_THAT([&] { run.Store("fit", "new key", WriteResult("mixture")); }, names_it);
  EXPECT_THAT([&] { run.Finish(); }, names_it);
  EXPECT_FALSE(HasPartialFolder());
  EXPECT_FALSE(run.Has("fit", "new key"));
  EXPECT_FALSE(ReadManifest(folder_ / "manifest.json").finished);
}

TEST_F(RunDirectoryTest, ExceptionWhileWritingKeepsTheEarlierResult) {
  MakeFinishedRun();
  RunDirectory run(folder_);
  EXPECT_THROW(run.Store("fit", "new key",
                         [](const fs::path& folder) {
                           WriteFileAtomically(folder / "result.txt", "half");
                           throw Interrupted(SIGINT);
                         }),
               Interrupted);
  EXPECT_FALSE(HasPartialFolder());
  EXPECT_FALSE(run.Has("fit", "new key"));
  EXPECT_TRUE(run.Has("fit", "key f"));
}

TEST_F(RunDirectoryTest, ProcessKilledWhileWritingLeavesNothingThatIsTrusted) {
  MakeFinishedRun();
  InKilledProcess([this] {
    RunDirectory run(folder_);
    run.Begin({}, {}, 0);
    run.Store("surface", "key s2", [](const fs::path& folder) {
      WriteFileAtomically(folder / "result.txt", "half");
      raise(SIGKILL);
    });
  });
  EXPECT_TRUE(HasPartialFolder());
  EXPECT_THAT([this] { FinishedStage(folder_, "surface"); },
              ThrowsMessage<InputError>(HasSubstr("was not finished")));
  RunDirectory run(folder_);  // the lock went with the process
  EXPECT_FALSE(HasPartialFolder());
  EXPECT_FALSE(run.Has("surface", "key s2"));
  EXPECT_TRUE(run.Has("surface", "key s"));
}

TEST_F(RunDirectoryTest, TheVeryFirstManifestMayBeKilledAndLeavesNothingBehind) {
  InKilledProcess([this] {
    RunDirectory run(folder_);
    AtomicFile manifest(folder_ / "manifest.json");
    manifest.Write("{");
    raise(SIGKILL);
  });
  const auto temporaries = [this] {
    int count = 0;
    for (const auto& entry : fs::directory_iterator(folder_))
      count += IsTemporaryFile(entry.path());
    return count;
  };
  EXPECT_EQ(temporaries(), 1);
  const RunDirectory run(folder_);  // the folder counts as a run all the same
  EXPECT_EQ(temporaries(), 0);
}

// A process stores two results in turn until it is killed. Whatever the moment, each result is
// afterwards complete or absent.
TEST_F(RunDirectoryTest, AfterAKillAtAnyMomentAStageIsCompleteOrAbsent) {
  constexpr int kRounds = 12;
  int whole = 0;
  for (int round = 0; round < kRounds; ++round) {
    int stored_once[2];
    ASSERT_EQ(pipe(stored_once), 0);
    const pid_t child = fork();
    if (child == 0) {
      RunDirectory run(folder_);
      run.Begin({}, {}, 0);
      run.Store("fit", "key a", WriteResult("a"));
      const auto begin = steady_clock::now();
      run.Store("fit", "key b", WriteResult("b"));
      const auto duration = steady_clock::now() - begin;
      if (write(stored_once[1], &duration, sizeof(duration)) < 0) _exit(1);
      for (;;) {
        run.Store("fit", "key a", WriteResult("a"));
        run.Store("fit", "key b", WriteResult("b"));
      }
    }
    close(stored_once[1]);
    // The moments are spread over two calls of Store, however long one takes on this disk.
    steady_clock::duration duration{};
    ASSERT_EQ(read(stored_once[0], &duration, sizeof(duration)), ssize_t{sizeof(duration)});
    std::this_thread::sleep_for(2 * duration * round / kRounds);
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    close(stored_once[0]);
    RunDirectory run(folder_);
    for (const std::string name : {"a", "b"}) {
      const StageCheck check = run.Check("fit", "key " + name);
      EXPECT_NE(check.status, Status::kDamaged) << check.message;
      if (!check.IsUsable()) continue;
      EXPECT_EQ(FileContent(run.StageFolder("fit") / "result.txt"), name);
      ++whole;
    }
  }
  EXPECT_GT(whole, 0) << "nothing that was stored has survived";
}

TEST_F(RunDirectoryTest, ResultsOfAnotherVersionAreNotResumed) {
  MakeFinishedRun();
  Manifest manifest = ReadManifest(folder_ / "manifest.json");
  manifest.library_versions["CGAL"] = "4.0";
  WriteManifest(manifest, folder_ / "manifest.json");
  RunDirectory run(folder_);
  EXPECT_EQ(run.Check("fit", "key f").status, Status::kAbsent);
}

TEST_F(RunDirectoryTest, ResultsUnknownToTheManifestAreNotTrusted) {
  MakeFinishedRun();
  // The state after a crash between the rename of the folder and the writing of the manifest.
  fs::copy(folder_ / "surface", folder_ / "mesh");
  RunDirectory run(folder_);
  EXPECT_EQ(run.Check("mesh", "key s").status, Status::kAbsent);
  run.Store("mesh", "key m", WriteResult("mesh"));
  EXPECT_EQ(FileContent(run.StageFolder("mesh") / "result.txt"), "mesh");
}

TEST_F(RunDirectoryTest, UnfinishedRunResumesWhereItStopped) {
  {
    RunDirectory run(folder_);
    run.Begin({}, {}, 0);
    run.Store("surface", "key s", WriteResult("surface"));
  }
  EXPECT_THAT([this] { FinishedStage(folder_, "surface"); },
              ThrowsMessage<InputError>(HasSubstr("was not finished")));
  RunDirectory run(folder_);
  run.Begin({}, {}, 0);
  EXPECT_TRUE(run.Has("surface", "key s"));
  EXPECT_FALSE(run.Has("fit", "key f"));
  run.Store("fit", "key f", WriteResult("fit"));
  run.Finish();
  EXPECT_EQ(FinishedStage(folder_, "fit"), folder_ / "fit");
}

TEST_F(RunDirectoryTest, FinishRemovesStagesOfAnEarlierConfiguration) {
  MakeFinishedRun();
  {
    RunDirectory run(folder_);
    run.Begin({{"other", true}}, {}, 0);
    EXPECT_TRUE(run.Has("surface", "key s"));
    run.Finish();
  }
  EXPECT_FALSE(fs::exists(folder_ / "fit"));
  EXPECT_TRUE(fs::exists(folder_ / "surface" / "result.txt"));
  EXPECT_THAT([this] { FinishedStage(folder_, "fit"); },
              ThrowsMessage<InputError>(HasSubstr("no results of the stage 'fit'")));
}

TEST_F(RunDirectoryTest, SecondRunInTheSameFolderIsRefusedWhileTheFirstLives) {
  std::optional<RunDirectory> first(folder_);
  EXPECT_THAT([this] { RunDirectory second(folder_); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr(folder_.string()), HasSubstr("in use by another run"))));
  first.reset();
  EXPECT_NO_THROW(RunDirectory second(folder_));
}

// Threads stand for commands, because the lock keeps threads apart, too. All of them open the
// folder again and again until one has stored a stage. Some are therefore looking at its contents
// at the moment at which the manifest and the stage appear, and must not take them for foreign
// files.
TEST_F(RunDirectoryTest, OfCommandsThatBeginInOneNewFolderOneOwnsItAndTheOthersAreToldSo) {
  constexpr int kRounds = 20, kCommands = 8;
  const std::string in_use = "is in use by another run";
  for (int round = 0; round < kRounds; ++round) {
    const fs::path folder = folder_ / std::to_string(round);
    std::latch start(kCommands);
    std::atomic<int> owners = 0, refused = 0, stored = 0;
    std::atomic<bool> over = false;
    const auto begin = [&] {
      start.arrive_and_wait();
      while (!over) {
        try {
          RunDirectory run(folder);
          EXPECT_EQ(++owners, 1) << "two commands own the folder at the same time";
          if (!run.Has("fit", "key")) {
            // The others are now busy with opening the folder.
            while (refused < kCommands && owners == 1 && !over) std::this_thread::yield();
            run.Begin({}, {}, 0);
            run.Store("fit", "key", WriteResult("fit"));
            ++stored;
          }
          over = true;
          --owners;
        } catch (const InputError& refusal) {
          const std::string message = refusal.what();
          EXPECT_THAT(message, AllOf(HasSubstr(in_use), Not(HasSubstr("()"))));
          if (message.find(in_use) == std::string::npos) over = true;
          ++refused;
        }
      }
    };
    std::vector<std::jthread> commands;
    for (int k = 0; k < kCommands; ++k) commands.emplace_back(begin);
    commands.clear();  // waits for all of them
    EXPECT_EQ(stored, 1) << "a command has not found the stage that another one has stored";
    EXPECT_TRUE(RunDirectory(folder).Has("fit", "key"));
    if (HasFailure()) break;
  }
}

TEST_F(RunDirectoryTest, FolderWithOtherContentsIsRefusedAndNotChanged) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "thesis.tex") << "x";
  EXPECT_THAT([this] { RunDirectory run(folder_); },
              ThrowsMessage<InputError>(HasSubstr("is not a run folder")));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder_), {}), 1);
}

TEST_F(RunDirectoryTest, ADamagedManifestStartsTheRunOver) {
  MakeFinishedRun();
  const fs::path manifest = folder_ / "manifest.json";
  fs::resize_file(manifest, fs::file_size(manifest) / 2);
  RunDirectory run(folder_);
  run.Begin({{"density", 1070.0}}, {{"scan.ply", "00"}}, 7);
  EXPECT_EQ(run.Check("surface", "key s").status, Status::kAbsent);
}

// Without the lock that every run leaves, the file may belong to another program.
TEST_F(RunDirectoryTest, AnUnreadableManifestOfAnotherProgramIsRefusedAndNotChanged) {
  fs::create_directories(folder_);
  std::ofstream(folder_ / "manifest.json") << "{ not ours";
  for (int attempt = 0; attempt < 2; ++attempt) {
    EXPECT_THAT([&] { RunDirectory run(folder_); },
                ThrowsMessage<InputError>(HasSubstr("is not a valid manifest")));
    EXPECT_EQ(FileContent(folder_ / "manifest.json"), "{ not ours");
  }
}

TEST_F(RunDirectoryTest, ErrorNamesAPlaceThatCannotBeAFolder) {
  std::ofstream(parent_ / "file") << "x";
  for (const fs::path& folder : {parent_ / "file", parent_ / "file/run", fs::path("/proc/run")}) {
    EXPECT_THAT([&] { RunDirectory run(folder); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(folder.string()),
                                                HasSubstr("cannot be used as a run folder"))));
  }
}

TEST_F(RunDirectoryTest, ResultHashDependsOnTheContentAndTheNames) {
  RunDirectory run(folder_);
  run.Begin({}, {}, 0);
  run.Store("surface", "k", WriteResult("a"));
  const std::string hash = run.ResultHash("surface");
  run.Store("surface", "k2", WriteResult("a"));
  EXPECT_EQ(run.ResultHash("surface"), hash);
  run.Store("surface", "k", WriteResult("b"));
  EXPECT_NE(run.ResultHash("surface"), hash);
}

}  // namespace
}  // namespace lacuna
