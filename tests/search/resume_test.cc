// A search that was stopped and resumes from its log.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <stdexcept>

#include "core/error.h"
#include "search/cobyla.h"
#include "search/gaussian_process_search.h"
#include "search/nlopt_search.h"
#include "search/problem_collection.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

using Search = std::function<SearchResult(const SearchProblem&, const SearchControl&)>;

SearchResult ByCobyla(CobylaMode mode, const SearchProblem& problem, const SearchControl& control) {
  CobylaOptions options;
  options.mode = mode;
  options.restarts.max_restarts = 100;
  return MinimiseByCobyla(problem, control, options);
}

SearchResult ByGaussianProcess(const SearchProblem& problem, const SearchControl& control) {
  return MinimiseByGaussianProcess(problem, control, {});
}

SearchResult ByNlopt(const SearchProblem& problem, const SearchControl& control) {
  return MinimiseByNlopt(problem, control, {});
}

class Resume : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::remove(file_);
    control_.max_evaluations = 40;
    control_.log_key = "stepped";
  }
  void TearDown() override { fs::remove(file_); }

  SearchResult RunModern() { return ByCobyla(CobylaMode::kModern, problem_, control_); }

  std::string Text() const {
    std::ifstream stream(file_, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
  }

  const fs::path file_ =
      fs::path(::testing::TempDir()) /
      (std::string("search_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
  SearchControl control_;
  SearchProblem problem_ = MakeSteppedProblem(0.02, 0.1, 3).problem;
};

TEST_F(Resume, AfterAStopAtAnyEvaluationGivesTheIdenticalTrace) {
  const Search searches[] = {
      [](const auto& p, const auto& c) { return ByCobyla(CobylaMode::kPowell, p, c); },
      [](const auto& p, const auto& c) { return ByCobyla(CobylaMode::kModern, p, c); },
      ByGaussianProcess, ByNlopt};
  int failures = 0;
  for (const Search& search : searches) {
    control_.log.clear();
    const SearchResult whole = search(problem_, control_);
    failures += whole.failures;
    const int count = static_cast<int>(whole.trace.size());
    for (int stop = 0; stop<count; stop += count> 30 ? 3 : 1) {
      fs::remove(file_);
      control_.log = file_;
      int calls = 0;
      SearchProblem dying = problem_;
      dying.evaluate = [&](const Eigen::VectorXd& x) {
        if (calls == stop) throw std::runtime_error("killed");
        ++calls;
        return problem_.evaluate(x);
      };
      EXPECT_THROW(search(dying, control_), std::runtime_error);
      int further = 0;
      SearchProblem counting = problem_;
      counting.evaluate = [&](const Eigen::VectorXd& x) {
        ++further;
        return problem_.evaluate(x);
      };
      const SearchResult resumed = search(counting, control_);
      EXPECT_EQ(resumed.trace_hash, whole.trace_hash) << "stopped at " << stop;
      EXPECT_EQ(resumed.best, whole.best);
      EXPECT_EQ(further, count - stop) << "evaluated again";
    }
  }
  EXPECT_GT(failures, 0) << "none has been resumed";
}

TEST_F(Resume, ContinuesWithALargerBudget) {
  control_.max_evaluations = 60;
  const SearchResult whole = RunModern();
  control_.log = file_;
  control_.max_evaluations = 20;
  EXPECT_EQ(RunModern().status, SearchStatus::kEvaluations);
  control_.max_evaluations = 60;
  const SearchResult resumed = RunModern();
  EXPECT_EQ(resumed.trace_hash, whole.trace_hash);
  EXPECT_TRUE(resumed.trace[19].from_log);
  EXPECT_FALSE(resumed.trace[20].from_log);
}

TEST_F(Resume, DropsAnIncompleteLastLine) {
  control_.log = file_;
  const SearchResult whole = RunModern();
  for (const int torn : {1, 10, 60}) {
    fs::resize_file(file_, fs::file_size(file_) - torn);
    EXPECT_EQ(RunModern().trace_hash, whole.trace_hash);
  }
}

TEST_F(Resume, RefusesADamagedLineAndTheLogOfAnotherSearch) {
  control_.log = file_;
  RunModern();
  const std::string sound = Text();
  std::string damaged = sound;
  damaged[sound.size() / 2] ^= 1;
  std::ofstream(file_, std::ios::binary) << damaged;
  EXPECT_THAT([&] { RunModern(); },
              ThrowsMessage<InputError>(HasSubstr("damaged; remove this file")));
  std::ofstream(file_, std::ios::binary) << sound;
  control_.log_key = "another objective";
  EXPECT_THAT([&] { RunModern(); },
              ThrowsMessage<InputError>(HasSubstr("another search; remove this file")));
  control_.log_key = "stepped";
  problem_.start[0] = 0.25;
  EXPECT_THAT([&] { RunModern(); }, ThrowsMessage<InputError>(HasSubstr("another search")));
}

TEST_F(Resume, KeepsTheReasonOfAFailure) {
  control_.log = file_;
  RunModern();
  const SearchResult read = RunModern();
  ASSERT_GT(read.failures, 0);
  for (const SearchStep& step : read.trace) {
    EXPECT_TRUE(step.from_log);
    if (!step.outcome.value) {
      EXPECT_EQ(step.outcome.failure, "the mesher refused");
    }
  }
}

}  // namespace
}  // namespace lacuna
