#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace lacuna {
namespace {

std::atomic<int> thread_count{0};

// How often a thread polls before it sleeps: a helper for the next loop, a caller for its helpers.
// This takes about 50 µs, the typical time between two loops of one computation.
constexpr int kSpins = 1000;

void Pause() {
#if defined(__x86_64__)
  _mm_pause();
#endif
}

// A loop in progress. The threads take its blocks one at a time.
struct Loop {
  Loop(int64_t count, int64_t block, const std::function<void(int64_t, int64_t)>& body,
       const Loop* outer)
      : count(count), block(block), blocks((count + block - 1) / block), body(body), outer(outer) {}

  const int64_t count, block, blocks;
  const std::function<void(int64_t, int64_t)>& body;
  const Loop* const outer;  // the loop in whose body this one runs; null if there is none
  std::atomic<int64_t> next = 0;
  std::atomic<int> helpers_inside = 0;
  std::mutex failure_mutex;
  std::exception_ptr failure;  // that of the first block that failed
  int64_t failed = std::numeric_limits<int64_t>::max();

  // Whether this loop runs in the body of the other one, at any depth.
  bool IsInside(const Loop* other) const {
    const Loop* one = outer;
    while (one != nullptr && one != other) one = one->outer;
    return one != nullptr;
  }

  void Work();
};

thread_local const Loop* innermost = nullptr;  // the loop on whose block this thread works
// Number of threads that work on the block of a loop and do not wait for helpers.
std::atomic<int> working{0};

void Loop::Work() {
  const Loop* const before = innermost;
  innermost = this;
  int64_t k = 0;
  try {
    for (k = next++; k < blocks; k = next++) body(k * block, std::min(count, (k + 1) * block));
  } catch (...) {
    next = blocks;
    // Blocks are taken in order, so all before this one are finished or still running.
    const std::lock_guard lock(failure_mutex);
    if (k < failed) {
      failed = k;
      failure = std::current_exception();
    }
  }
  innermost = before;
}

// The pool of helper threads. The caller of a loop does not wait until a helper has started, only
// until the helpers have finished the blocks that they have taken. If other programs occupy the
// cores, a loop is therefore hardly slower than on one thread. A barrier for all threads, as in
// OpenMP, would cost a time slice of the scheduler per loop.
//
// Loops may run inside others. A thread that has nothing left to do takes blocks of any loop; one
// that waits for the helpers of its loop takes blocks of loops inside that loop only, so that it
// never comes back later than it must, and no two threads wait for each other: each waits for a
// thread that is deeper inside.
class Helpers {
 public:
  // The pool is never destroyed, so the helpers need not be stopped at the end of the process.
  static Helpers& Get() {
    static Helpers& helpers = *new Helpers;
    return helpers;
  }

  void Run(Loop* loop) {
    const bool is_outermost = innermost == nullptr;
    {
      const std::lock_guard lock(mutex_);
      StartThreads();
      open_.push_back(loop);
      if (is_outermost) ++engaged_;
    }
    if (is_outermost) ++working;
    Announce();
    loop->Work();
    {
      const std::lock_guard lock(mutex_);
      std::erase(open_, loop);
    }
    --working;
    WaitFor([&] { return loop->helpers_inside == 0; }, loop);
    if (!is_outermost) {
      ++working;
      return;
    }
    const std::lock_guard lock(mutex_);
    --engaged_;
  }

 private:
  // Where the system allows no further thread, those that there are must do.
  void StartThreads() {
    try {
      for (; threads_ < ThreadCount() - 1; ++threads_)
        std::thread([this] { WaitFor([] { return false; }, nullptr); }).detach();
    } catch (const std::system_error&) {
    }
  }

  // Until the condition holds, takes part in loops inside `outer`, or in any if that is null.
  template <typename Condition>
  void WaitFor(const Condition& is_over, const Loop* outer) {
    int spins = 0;
    while (true) {
      const int64_t seen = changes_;
      if (is_over()) return;
      if (Loop* loop = Enter(outer)) {
        loop->Work();
        Leave(outer);
        if (--loop->helpers_inside == 0) Announce();  // the loop may be gone
        spins = 0;
        continue;
      }
      for (; spins < kSpins && changes_ == seen; ++spins) Pause();
      if (spins < kSpins) continue;
      changes_.wait(seen);
      spins = 0;
    }
  }

  // Joins the loop that was opened first among those that have blocks left. Null if there is none,
  // or if as many threads are engaged as should be.
  Loop* Enter(const Loop* outer) {
    const std::lock_guard lock(mutex_);
    if (outer == nullptr && engaged_ >= ThreadCount()) return nullptr;
    for (Loop* loop : open_) {
      if (loop->next >= loop->blocks || (outer != nullptr && !loop->IsInside(outer))) continue;
      ++loop->helpers_inside;
      ++working;
      if (outer == nullptr) ++engaged_;
      return loop;
    }
    return nullptr;
  }

  void Leave(const Loop* outer) {
    --working;
    if (outer != nullptr) return;
    const std::lock_guard lock(mutex_);
    --engaged_;
  }

  // Wakes the threads that wait: a loop was opened, or its last helper has left one.
  void Announce() {
    ++changes_;
    changes_.notify_all();
  }

  std::mutex mutex_;  // protects what follows but changes_, and the entry of helpers into a loop
  int threads_ = 0;
  int engaged_ = 0;          // threads that work on a loop or wait for its helpers
  std::vector<Loop*> open_;  // in the order in which they were opened
  std::atomic<int64_t> changes_ = 0;
};

}  // namespace

int ThreadCount() {
  // hardware_concurrency() is called once only, because it reads a file at each call.
  static const int cores = static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));
  const int count = thread_count.load();
  return count > 0 ? count : cores;
}

void SetThreadCount(int count) { thread_count.store(std::max(1, count)); }

void ParallelBlocks(int64_t count, int64_t block,
                    const std::function<void(int64_t begin, int64_t end)>& body) {
  const int64_t blocks = (count + block - 1) / block;
  // Inside a loop that occupies all threads, nobody would help.
  const bool has_help = std::min<int64_t>(blocks, ThreadCount()) > 1 &&
                        (innermost == nullptr || working < ThreadCount());
  if (!has_help) {
    for (int64_t k = 0; k < blocks; ++k) body(k * block, std::min(count, (k + 1) * block));
    return;
  }
  Loop loop(count, block, body, innermost);
  Helpers::Get().Run(&loop);
  if (loop.failure) std::rethrow_exception(loop.failure);
}

}  // namespace lacuna
