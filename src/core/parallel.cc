#include "core/parallel.h"

#include <omp.h>

#include <algorithm>
#include <atomic>
#include <exception>

namespace lacuna {
namespace {

std::atomic<int> thread_count{0};

}  // namespace

int ThreadCount() {
  const int count = thread_count.load();
  return count > 0 ? count : omp_get_num_procs();
}

void SetThreadCount(int count) { thread_count.store(std::max(1, count)); }

void ParallelBlocks(int64_t count, int64_t block,
                    const std::function<void(int64_t begin, int64_t end)>& body) {
  const int64_t blocks = (count + block - 1) / block;
  if (blocks <= 1 || ThreadCount() == 1 || omp_in_parallel()) {
    for (int64_t k = 0; k < blocks; ++k) body(k * block, std::min(count, (k + 1) * block));
    return;
  }
  // An exception must not leave an OpenMP region: the first one is carried out by hand.
  std::exception_ptr failure;
#pragma omp parallel for schedule(dynamic, 1) num_threads(ThreadCount())
  for (int64_t k = 0; k < blocks; ++k) {
    try {
      body(k * block, std::min(count, (k + 1) * block));
    } catch (...) {
#pragma omp critical(lacuna_parallel_failure)
      if (!failure) failure = std::current_exception();
    }
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace lacuna
