#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

namespace lacuna {
namespace {

class ThreadCountGuard {
 public:
  ThreadCountGuard() : before_(ThreadCount()) {}
  ~ThreadCountGuard() { SetThreadCount(before_); }

 private:
  int before_;
};

TEST(Parallel, VisitsEachIndexOnceWithAnyThreadCount) {
  ThreadCountGuard guard;
  for (const int threads : {1, 2, 5}) {
    SetThreadCount(threads);
    std::vector<int> visits(1003, 0);
    ParallelFor(1003, 10, [&](int64_t i) { ++visits[i]; });
    for (const int count : visits) EXPECT_EQ(count, 1);
  }
}

TEST(Parallel, BlocksDoNotDependOnTheThreadCount) {
  ThreadCountGuard guard;
  for (const int threads : {1, 2}) {
    SetThreadCount(threads);
    std::vector<int64_t> ends(4, -1);
    ParallelBlocks(35, 10, [&](int64_t begin, int64_t end) { ends[begin / 10] = end; });
    EXPECT_EQ(ends, (std::vector<int64_t>{10, 20, 30, 35}));
  }
}

TEST(Parallel, RethrowsAnExceptionInTheCaller) {
  EXPECT_THROW(ParallelFor(100, 1,
                           [](int64_t i) {
                             if (i == 57) throw std::runtime_error("57");
                           }),
               std::runtime_error);
}

TEST(Parallel, RethrowsTheExceptionOfTheFirstBlock) {
  ThreadCountGuard guard;
  SetThreadCount(4);
  for (int repeat = 0; repeat < 200; ++repeat) {
    try {
      ParallelFor(8, 1, [](int64_t i) {
        if (i == 1) std::this_thread::sleep_for(std::chrono::microseconds(50));
        if (i > 0) throw std::runtime_error(std::to_string(i));
      });
      FAIL() << "no exception";
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "1");
    }
  }
}

TEST(Parallel, RunsALoopInsideALoop) {
  ThreadCountGuard guard;
  SetThreadCount(3);
  std::vector<int> visits(40 * 50, 0);
  ParallelFor(40, 1,
              [&](int64_t i) { ParallelFor(50, 1, [&](int64_t j) { ++visits[50 * i + j]; }); });
  for (const int count : visits) EXPECT_EQ(count, 1);
}

TEST(Parallel, RunsLoopsOfSeveralCallersAtTheSameTime) {
  ThreadCountGuard guard;
  SetThreadCount(2);
  constexpr int kCallers = 4, kLoops = 500;
  std::vector<int64_t> sums(kCallers, 0);
  std::vector<std::thread> callers;
  for (int caller = 0; caller < kCallers; ++caller) {
    callers.emplace_back([&sums, caller] {
      for (int loop = 0; loop < kLoops; ++loop) {
        std::vector<int64_t> values(64, 0);
        ParallelFor(64, 8, [&](int64_t i) { values[i] = i; });
        for (const int64_t value : values) sums[caller] += value;
      }
    });
  }
  for (std::thread& caller : callers) caller.join();
  EXPECT_EQ(sums, std::vector<int64_t>(kCallers, kLoops * 64 * 63 / 2));
}

// The caller has nothing left to do long before its helper has finished, so that it polls in vain
// and has to sleep.
TEST(Parallel, WaitsForAHelperThatTakesLonger) {
  ThreadCountGuard guard;
  SetThreadCount(2);
  const std::thread::id caller = std::this_thread::get_id();
  for (int repeat = 0; repeat < 20; ++repeat) {
    std::atomic<bool> has_help = false;
    std::vector<int> results(2, 0);
    ParallelFor(2, 1, [&](int64_t i) {
      if (std::this_thread::get_id() == caller) {
        // The caller leaves a block to the helper, but does not wait for ever for one.
        const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
        while (!has_help && std::chrono::steady_clock::now() < end) std::this_thread::yield();
      } else {
        has_help = true;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
      }
      results[i] = 1 + static_cast<int>(i);
    });
    ASSERT_TRUE(has_help);
    EXPECT_EQ(results, (std::vector<int>{1, 2}));
  }
}

TEST(Parallel, DoesNothingForAnEmptyRange) {
  ParallelFor(0, 8, [](int64_t) { ADD_FAILURE(); });
}

}  // namespace
}  // namespace lacuna
