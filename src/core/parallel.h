// Parallel loops whose results do not depend on the number of threads.
//
// Results are identical to the last bit for any number of threads if the caller obeys one rule: a
// body writes only to locations that belong to its own index, and sums are computed per block and
// then added in the order of the blocks.
#ifndef LACUNA_CORE_PARALLEL_H_
#define LACUNA_CORE_PARALLEL_H_

#include <cstdint>
#include <functional>

namespace lacuna {

// The number of threads that the loops below use; initially the number of the machine's cores.
int ThreadCount();
// Sets that number; values below 1 count as 1.
void SetThreadCount(int count);

// Calls body(begin, end) for the consecutive blocks [k·block, (k+1)·block) of [0, count), in any
// order and possibly at the same time. The blocks depend on `count` and `block` only; `block` must
// be positive. A loop inside a body uses the threads that have nothing else to do when it begins.
// While a thread waits for the end of a loop, it may call bodies of loops inside that loop, so that
// no body may need a lock that is held around the loop. If a body throws an exception, the loop
// ends early and the exception is rethrown to the caller; if several bodies throw, that of the
// first block is rethrown, as in a serial loop.
void ParallelBlocks(int64_t count, int64_t block,
                    const std::function<void(int64_t begin, int64_t end)>& body);

// Calls body(i) for each i in [0, count), grouped in blocks as above.
template <typename Body>
void ParallelFor(int64_t count, int64_t block, const Body& body) {
  ParallelBlocks(count, block, [&body](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace lacuna

#endif  // LACUNA_CORE_PARALLEL_H_
