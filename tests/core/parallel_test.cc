#include "core/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <numeric>
#include <set>
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

// Runs loops of two blocks until two threads are inside one of them at the same time, a hundred
// loops at most. Returns the two threads, or none.
std::set<std::thread::id> MeetInsideALoop() {
  std::mutex mutex;
  std::set<std::thread::id> inside, met;
  std::atomic<bool> have_met = false;
  for (int repeat = 0; repeat < 100 && !have_met; ++repeat) {
    ParallelFor(2, 1, [&](int64_t) {
      const std::thread::id own = std::this_thread::get_id();
      for (int k = 0; k < 1000 && !have_met; ++k) {
        {
          const std::lock_guard lock(mutex);
          inside.insert(own);
          if (inside.size() == 2) {
            met = inside;
            have_met = true;
          }
        }
        std::this_thread::yield();
      }
      const std::lock_guard lock(mutex);
      inside.erase(own);
    });
  }
  return met;
}

// One block of a loop contains loops. The caller, which has finished the other block and waits,
// helps in these.
TEST(Parallel, HelpsInsideALoopWhileItWaits) {
  ThreadCountGuard guard;
  SetThreadCount(2);
  const std::thread::id caller = std::this_thread::get_id();
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  bool caller_helps = false;
  while (!caller_helps && std::chrono::steady_clock::now() < end) {
    std::atomic<bool> has_help = false;
    ParallelFor(2, 1, [&](int64_t) {
      if (std::this_thread::get_id() == caller) {
        while (!has_help && std::chrono::steady_clock::now() < end) std::this_thread::yield();
        return;
      }
      has_help = true;
      caller_helps = MeetInsideALoop().contains(caller);
    });
  }
  EXPECT_TRUE(caller_helps);
}

// The helper has finished the other block, and helps the caller in loops inside its own block.
TEST(Parallel, AThreadWithoutWorkHelpsInsideALoop) {
  ThreadCountGuard guard;
  SetThreadCount(2);
  const std::thread::id caller = std::this_thread::get_id();
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  size_t met = 0;
  while (met < 2 && std::chrono::steady_clock::now() < end) {
    ParallelFor(2, 1, [&](int64_t i) {
      if (i == 0 && std::this_thread::get_id() == caller) met = MeetInsideALoop().size();
    });
  }
  EXPECT_EQ(met, 2u);
}

// Sums that are formed in three levels of loops, with bodies of unequal length.
TEST(Parallel, NestedLoopsGiveTheSameWithAnyThreadCount) {
  ThreadCountGuard guard;
  std::vector<std::vector<double>> results;
  for (const int threads : {1, 2, 3, 5, 2}) {
    SetThreadCount(threads);
    std::atomic<int> inside = 0, most = 0;
    std::vector<double> sums(3 * 4, 0);
    ParallelFor(3, 1, [&](int64_t i) {
      ParallelFor(4, 1, [&](int64_t j) {
        std::vector<double> parts(50, 0);
        ParallelFor(50, 7, [&](int64_t k) {
          const int now = ++inside;
          for (int seen = most; now > seen && !most.compare_exchange_weak(seen, now);) {
          }
          for (int64_t n = 0; n < 20 * (i + j + 1); ++n) std::this_thread::yield();
          parts[k] = 1.0 / static_cast<double>(1 + k + 50 * (j + 4 * i));
          --inside;
        });
        sums[4 * i + j] = std::accumulate(parts.begin(), parts.end(), 0.0);
      });
    });
    results.push_back(sums);
    EXPECT_LE(most, threads);
    EXPECT_EQ(sums, results.front()) << threads;
  }
}

TEST(Parallel, RethrowsFromALoopInsideALoop) {
  ThreadCountGuard guard;
  SetThreadCount(3);
  for (int repeat = 0; repeat < 100; ++repeat) {
    EXPECT_THROW(ParallelFor(2, 1,
                             [](int64_t i) {
                               ParallelFor(8, 1, [&](int64_t j) {
                                 std::this_thread::yield();
                                 if (i == 1 && j == 5) throw std::runtime_error("5");
                               });
                             }),
                 std::runtime_error);
  }
  std::vector<int> visits(10, 0);
  ParallelFor(10, 1, [&](int64_t i) { ++visits[i]; });
  EXPECT_EQ(visits, std::vector<int>(10, 1));
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
