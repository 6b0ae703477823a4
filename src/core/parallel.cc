#include "core/parallel.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace lacuna {
namespace {

std::atomic<int> thread_count{0};
thread_local bool inside_loop = false;

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
  Loop(int64_t count, int64_t block, const std::function<void(int64_t, int64_t)>& body, int helpers)
      : count(count),
        block(block),
        blocks((count + block - 1) / block),
        body(body),
        helpers_wanted(helpers) {}

  const int64_t count, block, blocks;
  const std::function<void(int64_t, int64_t)>& body;
  const int helpers_wanted;
  std::atomic<int64_t> next = 0;
  std::atomic<int> helpers_inside = 0;
  std::mutex failure_mutex;
  std::exception_ptr failure;  // that of the first block that failed
  int64_t failed = std::numeric_limits<int64_t>::max();

  void Work() {
    inside_loop = true;
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
    inside_loop = false;
  }
};

// The pool of helper threads. The caller of a loop does not wait until a helper has started, only
// until the helpers have finished the blocks that they have taken. If other programs occupy the
// cores, a loop is therefore hardly slower than on one thread. A barrier for all threads, as in
// OpenMP, would cost a time slice of the scheduler per loop.
class Helpers {
 public:
  // The pool is never destroyed, so the helpers need not be stopped at the end of the process.
  static Helpers& Get() {
    static Helpers& helpers = *new Helpers;
    return helpers;
  }

  // Returns false without running the loop if another thread's loop is using the helpers.
  bool Run(Loop* loop) {
    const std::unique_lock mine(in_use_, std::try_to_lock);
    if (!mine) return false;
    for (; threads_ < loop->helpers_wanted; ++threads_) std::thread([this] { Help(); }).detach();
    {
      const std::lock_guard lock(mutex_);
      current_ = loop;
    }
    ++loops_;
    loops_.notify_all();
    loop->Work();
    {
      const std::lock_guard lock(mutex_);
      current_ = nullptr;
    }
    for (int k = 0; k < kSpins && loop->helpers_inside > 0; ++k) Pause();
    for (int64_t seen = left_; loop->helpers_inside > 0; seen = left_) left_.wait(seen);
    return true;
  }

 private:
  void Help() {
    int64_t seen = 0;
    while (true) {
      for (int k = 0; k < kSpins && loops_ == seen; ++k) Pause();
      loops_.wait(seen);
      seen = loops_;
      Loop* loop = Enter();
      if (loop == nullptr) continue;
      loop->Work();
      --loop->helpers_inside;  // after which the loop may be gone
      ++left_;
      left_.notify_one();
    }
  }

  Loop* Enter() {
    const std::lock_guard lock(mutex_);
    if (current_ == nullptr || current_->helpers_inside >= current_->helpers_wanted) return nullptr;
    ++current_->helpers_inside;
    return current_;
  }

  std::mutex in_use_;
  int threads_ = 0;
  std::mutex mutex_;  // protects current_ and the entry of helpers into its loop
  Loop* current_ = nullptr;
  std::atomic<int64_t> loops_ = 0;
  std::atomic<int64_t> left_ = 0;  // how often a helper has left a loop
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
  const int threads = static_cast<int>(std::min<int64_t>(blocks, ThreadCount()));
  if (threads > 1 && !inside_loop) {
    Loop loop(count, block, body, threads - 1);
    if (Helpers::Get().Run(&loop)) {
      if (loop.failure) std::rethrow_exception(loop.failure);
      return;
    }
  }
  for (int64_t k = 0; k < blocks; ++k) body(k * block, std::min(count, (k + 1) * block));
}

}  // namespace lacuna
