#include "core/interrupt.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>

namespace lacuna {
namespace {

TEST(Interrupt, SignalIsRememberedUntilASafePoint) {
  signal(SIGINT, SIG_DFL);  // tests that run in the background of a script inherit SIG_IGN
  InstallInterruptHandler();
  EXPECT_FALSE(InterruptRequested());
  EXPECT_NO_THROW(ThrowIfInterrupted());
  raise(SIGINT);
  EXPECT_TRUE(InterruptRequested());
  try {
    ThrowIfInterrupted();
    FAIL() << "no exception";
  } catch (const Interrupted& interrupted) {
    EXPECT_EQ(interrupted.ExitCode(), 130);
  }
  ClearInterrupt();
  EXPECT_FALSE(InterruptRequested());
}

TEST(InterruptDeathTest, SecondSignalEndsTheProgram) {
  const auto twice = [] {
    InstallInterruptHandler();
    raise(SIGTERM);
    if (!InterruptRequested()) std::_Exit(1);
    raise(SIGTERM);
    std::_Exit(0);
  };
  EXPECT_EXIT(twice(), ::testing::KilledBySignal(SIGTERM), "");
}

TEST(InterruptDeathTest, SignalIgnoredByTheParentStaysIgnored) {
  const auto in_background = [] {
    signal(SIGINT, SIG_IGN);  // as a shell does for a job started with & in a script
    InstallInterruptHandler();
    raise(SIGINT);
    std::_Exit(InterruptRequested() ? 1 : 0);
  };
  EXPECT_EXIT(in_background(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace lacuna
