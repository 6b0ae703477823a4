#include "core/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace lacuna {
namespace {

using nlohmann::json;
using ::testing::HasSubstr;

// A Progress that writes to a string and reads a clock that the test sets.
class ProgressTest : public ::testing::Test {
 protected:
  ProgressOptions Options(ProgressStyle style) {
    ProgressOptions options;
    options.style = style;
    options.stream = &stream_;
    options.clock = [this] { return now_; };
    return options;
  }
  std::vector<json> Lines() const {
    std::vector<json> lines;
    std::istringstream text(stream_.str());
    for (std::string line; std::getline(text, line);) lines.push_back(json::parse(line));
    return lines;
  }
  std::ostringstream stream_;
  double now_ = 1000;
};

TEST_F(ProgressTest, JsonLinesReportStageFrameResidualAndRemainingTime) {
  Progress progress(Options(ProgressStyle::kJsonLines));
  progress.Begin("fit", 20);
  now_ += 6;
  progress.Report(3, 0.25);
  now_ += 34;
  progress.Report(20, 0.125);
  progress.End("all converged");
  const std::vector<json> lines = Lines();
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[0]["event"], "begin");
  EXPECT_TRUE(lines[0]["remaining_s"].is_null());
  EXPECT_EQ(lines[1]["event"], "progress");
  EXPECT_EQ(lines[1]["stage"], "fit");
  EXPECT_EQ(lines[1]["done"], 3);
  EXPECT_EQ(lines[1]["total"], 20);
  EXPECT_EQ(lines[1]["residual"], 0.25);
  EXPECT_EQ(lines[1]["elapsed_s"], 6);
  EXPECT_EQ(lines[1]["remaining_s"], 34);  // 2 s per frame, 17 frames left
  EXPECT_EQ(lines[3]["event"], "end");
  EXPECT_EQ(lines[3]["residual"], 0.125);
  EXPECT_EQ(lines[3]["remaining_s"], 0);
  EXPECT_EQ(lines[3]["note"], "all converged");
}

TEST_F(ProgressTest, JsonLinesAreRateLimitedExceptForTheEnd) {
  Progress progress(Options(ProgressStyle::kJsonLines));
  progress.Begin("scan", 1000);
  for (int frame = 1; frame <= 1000; ++frame) {
    now_ += 0.01;
    progress.Report(frame);
  }
  progress.End();
  // 10 s at one line per second, plus the beginning and the end; ± 1 for rounding of the clock.
  EXPECT_NEAR(static_cast<double>(Lines().size()), 12, 1);
  EXPECT_EQ(Lines().back()["done"], 1000);
}

TEST_F(ProgressTest, UnknownTotalAndResidualAreNullAndAnyTextIsValidJson) {
  Progress progress(Options(ProgressStyle::kJsonLines));
  progress.Begin("a \"quoted\"\n stage \xff", 0);
  now_ += 2;
  progress.Report(5);
  const std::vector<json> lines = Lines();
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_TRUE(lines[1]["total"].is_null());
  EXPECT_TRUE(lines[1]["residual"].is_null());
  EXPECT_TRUE(lines[1]["remaining_s"].is_null());
}

TEST_F(ProgressTest, NewStageEndsTheOpenOne) {
  Progress progress(Options(ProgressStyle::kJsonLines));
  progress.Begin("first", 1);
  progress.Begin("second", 1);
  progress.End();
  progress.End();
  const std::vector<json> lines = Lines();
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[1]["event"], "end");
  EXPECT_EQ(lines[1]["stage"], "first");
}

TEST_F(ProgressTest, AbandonedStageIsNotReportedAsEnded) {
  {
    Progress progress(Options(ProgressStyle::kJsonLines));
    progress.Begin("first", 1);
  }
  EXPECT_EQ(Lines().size(), 1u);
}

TEST_F(ProgressTest, LiveLineIsRewrittenInPlaceAndKeptAtTheEnd) {
  Progress progress(Options(ProgressStyle::kLiveLine));
  progress.Begin("fit", 20);
  now_ += 60;
  progress.Report(10, 0.0125);
  EXPECT_EQ(stream_.str().find('\n'), std::string::npos);
  EXPECT_THAT(stream_.str(), HasSubstr("10 / 20"));
  EXPECT_THAT(stream_.str(), HasSubstr("residual 0.0125"));
  EXPECT_THAT(stream_.str(), HasSubstr("1:00 min, 1:00 min remaining"));
  progress.End("done");
  EXPECT_EQ(stream_.str().back(), '\n');
}

TEST_F(ProgressTest, CountsCallsFromSeveralThreads) {
  Progress progress(Options(ProgressStyle::kJsonLines));
  progress.Begin("predict", 200);
  const std::function<void()> count = StageCounter(&progress);
  std::vector<std::thread> threads;
  for (int thread = 0; thread < 2; ++thread)
    threads.emplace_back([&] {
      for (int frame = 0; frame < 100; ++frame) count();
    });
  for (std::thread& thread : threads) thread.join();
  progress.Begin("score", 0);
  const std::function<void()> count_anew = StageCounter(&progress);
  count_anew();
  progress.End();
  const std::vector<json> lines = Lines();
  ASSERT_EQ(lines.size(), 4u);
  EXPECT_EQ(lines[1]["done"], 200);
  EXPECT_EQ(lines[3]["done"], 1);
}

TEST_F(ProgressTest, SilentStyleWritesNothing) {
  Progress progress(Options(ProgressStyle::kSilent));
  progress.Begin("fit", 20);
  now_ += 60;
  progress.Report(10);
  progress.End();
  EXPECT_EQ(stream_.str(), "");
}

}  // namespace
}  // namespace lacuna
