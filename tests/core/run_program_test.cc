#include "core/run_program.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <csignal>

#include "core/error.h"
#include "support/interrupted_call.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// The scripts have no programs but those of the shell itself and of /bin.
class RunProgramTest : public ::testing::Test {
 protected:
  ProgramCall Script(const std::string& text) const {
    std::ofstream(folder_ / "script") << "#!/bin/sh\n" << text << "\n";
    chmod((folder_ / "script").c_str(), 0755);
    return {.program = folder_ / "script", .output = folder_ / "output"};
  }
  std::string Output() const { return FileContent(folder_ / "output"); }

  const TemporaryFolder folder_;
};

TEST_F(RunProgramTest, PassesArgumentsFolderAndEnvironmentOn) {
  std::filesystem::create_directory(folder_ / "inside");
  setenv("LACUNA_TEST_KEPT", "kept", 1);
  setenv("LACUNA_TEST_SET", "old", 1);
  ProgramCall call = Script("echo \"$1 $LACUNA_TEST_KEPT $LACUNA_TEST_SET\"; echo > made");
  call.arguments = {"a b"};
  call.folder = folder_ / "inside";
  call.environment = {"LACUNA_TEST_SET=new"};
  EXPECT_EQ(RunProgram(call), 0);
  EXPECT_EQ(Output(), "a b kept new\n");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "inside/made"));
}

TEST_F(RunProgramTest, ReturnsTheExitStatus) {
  EXPECT_EQ(RunProgram(Script("exit 3")), 3);
  EXPECT_EQ(RunProgram(Script("kill -9 $$")), -1);
}

TEST_F(RunProgramTest, ReplacesTheOutputAndAddsErrorsOnRequest) {
  std::ofstream(folder_ / "output") << "of an earlier run";
  ProgramCall call = Script("echo one; echo two >&2");
  call.with_errors = true;
  EXPECT_EQ(RunProgram(call), 0);
  EXPECT_EQ(Output(), "one\ntwo\n");
}

TEST_F(RunProgramTest, SaysWhatCannotBeRun) {
  EXPECT_THAT([&] { RunProgram({.program = folder_ / "absent", .output = folder_ / "output"}); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("absent cannot be run with"), HasSubstr("No such file"))));
  ProgramCall call = Script("exit 0");
  call.folder = folder_.Path();
  call.output = folder_ / "no_folder/output";
  EXPECT_THAT([&] { RunProgram(call); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("in " + call.folder.string()),
                                              HasSubstr("the output " + call.output.string()))));
}

// Without a status, waitpid fails for ever.
TEST_F(RunProgramTest, EndsWithoutAStatusWhereChildrenAreIgnored) {
  const auto before = signal(SIGCHLD, SIG_IGN);
  EXPECT_EQ(RunProgram(Script("exit 0")), -1);
  signal(SIGCHLD, before);
}

TEST_F(RunProgramTest, FindsAProgramOnThePath) {
  EXPECT_EQ(FindProgram("no-such-program-anywhere"), std::nullopt);
  ASSERT_TRUE(FindProgram("sh"));
  EXPECT_EQ(RunProgram({.program = *FindProgram("sh"),
                        .arguments = {"-c", "exit 7"},
                        .output = folder_ / "output"}),
            7);
}

// Runs a script in this folder that continues with `then`, and interrupts it.
[[noreturn]] void InterruptScript(const TemporaryFolder& folder, const std::string& then) {
  WriteNumberedScript(folder / "script", folder / "number", then);
  ExitAfterInterruptedCall(folder / "number", [&] {
    RunProgram({.program = folder / "script", .output = folder / "output"});
  });
}

TEST(RunProgramDeathTest, AnInterruptEndsTheProgram) {
  const TemporaryFolder folder;
  EXPECT_EXIT(InterruptScript(folder, "exec /bin/sleep 60"), ::testing::ExitedWithCode(0), "");
}

TEST(RunProgramDeathTest, AProgramThatIgnoresTheSignalIsKilled) {
  const TemporaryFolder folder;
  EXPECT_EXIT(InterruptScript(folder, "trap '' TERM; exec /bin/sleep 60"),
              ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace lacuna
