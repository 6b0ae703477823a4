// The random numbers of the process, srand() and rand() of the C library.
//
// METIS and TetGen seed them and draw from them, so that their results can be repeated, but only as
// long as no other thread draws or seeds in between.
#ifndef LACUNA_CORE_PROCESS_RANDOM_H_
#define LACUNA_CORE_PROCESS_RANDOM_H_

#include <mutex>

namespace lacuna {

// To be held during a call of a library that uses the random numbers of the process.
std::mutex& ProcessRandomMutex();

}  // namespace lacuna

#endif  // LACUNA_CORE_PROCESS_RANDOM_H_
