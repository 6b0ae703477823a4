// Loops over both cores whose results do not depend on how many there are.
//
// The rule that keeps results bit-identical for any number of threads: a body writes only to
// places that belong to its own index, and sums are formed per block and added in block order.
#ifndef LACUNA_CORE_PARALLEL_H_
#define LACUNA_CORE_PARALLEL_H_

#include <cstdint>
#include <functional>

namespace lacuna {

// The number of threads that the loops below use; at first that of the machine's cores.
int ThreadCount();
void SetThreadCount(int count);

// Calls body(begin, end) for consecutive blocks [k·block, (k+1)·block) of [0, count). The blocks
// depend on `count` and `block` alone, never on the number of threads; they run in any order.
void ParallelBlocks(int64_t count, int64_t block,
                    const std::function<void(int64_t begin, int64_t end)>& body);

// Calls body(i) for each i in [0, count), in any order.
template <typename Body>
void ParallelFor(int64_t count, int64_t block, const Body& body) {
  ParallelBlocks(count, block, [&body](int64_t begin, int64_t end) {
    for (int64_t i = begin; i < end; ++i) body(i);
  });
}

}  // namespace lacuna

#endif  // LACUNA_CORE_PARALLEL_H_
