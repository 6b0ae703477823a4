#include "core/parallel.h"

#include <gtest/gtest.h>

#include <stdexcept>
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

TEST(Parallel, CarriesAnExceptionToTheCaller) {
  EXPECT_THROW(ParallelFor(100, 1,
                           [](int64_t i) {
                             if (i == 57) throw std::runtime_error("57");
                           }),
               std::runtime_error);
}

TEST(Parallel, DoesNothingForAnEmptyRange) {
  ParallelFor(0, 8, [](int64_t) { ADD_FAILURE(); });
}

}  // namespace
}  // namespace lacuna
