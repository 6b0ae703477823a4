#include "core/interrupt.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <thread>

#include "core/workers.h"

namespace lacuna {
namespace {

// Tests that run in the background of a script inherit that SIGINT is ignored.
void Install() {
  signal(SIGINT, SIG_DFL);
  InstallInterruptHandler();
}

// The signal is taken by another thread.
bool IsRequestedSoon() {
  for (int wait = 0; wait < 1000 && !InterruptRequested(); ++wait)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  return InterruptRequested();
}

[[noreturn]] void NeverStop() {
  for (;;) std::this_thread::sleep_for(std::chrono::seconds(1));
}

TEST(InterruptDeathTest, ASignalIsRememberedUntilASafePoint) {
  const auto interrupted = [] {
    Install();
    ThrowIfInterrupted();
    if (InterruptRequested()) std::_Exit(1);
    kill(getpid(), SIGINT);
    if (!IsRequestedSoon()) std::_Exit(2);
    try {
      ThrowIfInterrupted();
    } catch (const Interrupted& stopped) {
      std::_Exit(stopped.ExitCode());
    }
  };
  EXPECT_EXIT(interrupted(), ::testing::ExitedWithCode(130), "");
}

TEST(InterruptDeathTest, ASecondSignalEndsTheProgram) {
  const auto twice = [] {
    Install();
    kill(getpid(), SIGTERM);
    if (!IsRequestedSoon()) std::_Exit(1);
    kill(getpid(), SIGTERM);
    NeverStop();
  };
  EXPECT_EXIT(twice(), ::testing::KilledBySignal(SIGTERM), "");
}

TEST(InterruptDeathTest, WhatDoesNotStopIsEndedAfterTheGrace) {
  const auto stuck = [] {
    Install();
    kill(getpid(), SIGTERM);
    NeverStop();
  };
  const auto begin = std::chrono::steady_clock::now();
  EXPECT_EXIT(stuck(), ::testing::ExitedWithCode(143), "run the same command again");
  EXPECT_LT(std::chrono::steady_clock::now() - begin, 4 * kStopGrace);
}

// As METIS does while it works.
TEST(InterruptDeathTest, AHandlerOfALibraryIsNotCalled) {
  const auto replaced = [] {
    Install();
    signal(SIGTERM, [](int) { std::_Exit(1); });
    kill(getpid(), SIGTERM);
    if (!IsRequestedSoon()) std::_Exit(2);
    std::_Exit(0);
  };
  EXPECT_EXIT(replaced(), ::testing::ExitedWithCode(0), "");
}

TEST(InterruptDeathTest, ASignalIgnoredByTheParentStaysIgnored) {
  const auto in_background = [] {
    signal(SIGINT, SIG_IGN);  // as a shell does for a job started with & in a script
    InstallInterruptHandler();
    kill(getpid(), SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    std::_Exit(InterruptRequested() ? 1 : 0);
  };
  EXPECT_EXIT(in_background(), ::testing::ExitedWithCode(0), "");
}

// The jobs of workers are forked; each waits for signals itself.
TEST(InterruptDeathTest, StopsTheJobsOfWorkers) {
  const auto run_jobs = [] {
    Install();
    std::thread([] {
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
      kill(getpid(), SIGTERM);
    }).detach();
    const bool done = RunInProcesses(2, {.workers = 2}, [](size_t) {
      for (;;) {
        ThrowIfInterrupted();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
      }
    });
    std::_Exit(!done && InterruptRequested() ? 0 : 1);
  };
  EXPECT_EXIT(run_jobs(), ::testing::ExitedWithCode(0), "");
}

}  // namespace
}  // namespace lacuna
