#include "core/logging.h"

#include <gtest/gtest.h>

#include <cstdlib>

namespace lacuna {
namespace {

// These run in processes of their own because logging can be initialised only once per process.
TEST(LoggingDeathTest, EachMessageAppearsOnceInTheCompactForm) {
  const auto log = [] {
    InitialiseLogging("test", LogLevel::kInfo);
    LOG(INFO) << "seen";
    VLOG(1) << "too detailed";
    std::_Exit(0);
  };
  EXPECT_EXIT(log(), ::testing::ExitedWithCode(0), "^I [0-9:.]+ logging_test.cc:[0-9]+\\] seen\n$");
}

TEST(LoggingDeathTest, MessagesBelowTheLevelAreDropped) {
  const auto log = [] {
    InitialiseLogging("test");
    LOG(INFO) << "not seen";
    LOG(WARNING) << "seen";
    SetLogLevel(LogLevel::kError);
    LOG(WARNING) << "not seen";
    SetLogLevel(LogLevel::kDebug);
    VLOG(1) << "seen too";
    std::_Exit(0);
  };
  EXPECT_EXIT(log(), ::testing::ExitedWithCode(0), "^W [^\n]* seen\nI [^\n]* seen too\n$");
}

TEST(LoggingDeathTest, FailedCheckReportsItsConditionAndAborts) {
  const auto fail = [] {
    InitialiseLogging("test", LogLevel::kError);
    CHECK_EQ(1, 2) << "the cause";
  };
  EXPECT_EXIT(fail(), ::testing::KilledBySignal(SIGABRT),
              "F [^\n]*Check failed: 1 == 2 [^\n]*the cause");
}

}  // namespace
}  // namespace lacuna
