// A limit on the memory of the process, so that what does not fit is refused before it is begun.
//
// The limit is that on the data of the process (RLIMIT_DATA, `ulimit -d`), which child processes
// inherit; without one it is the machine's memory. The few large things of a computation, such as
// the factor of a stiffness matrix, are announced before they are allocated. Everything else that
// exceeds a limit fails as std::bad_alloc.
#ifndef LACUNA_CORE_MEMORY_LIMIT_H_
#define LACUNA_CORE_MEMORY_LIMIT_H_

#include <cstdint>
#include <string>

namespace lacuna {

// Lowers the limit of this process to so many bytes.
void SetMemoryLimit(uint64_t bytes);

// The limit, bytes.
uint64_t MemoryLimit();

// What the process occupies now of that: its data, which a limit counts whether they were written
// to or not, or without a limit its pages. Bytes.
uint64_t MemoryInUse();

// Where `bytes` more than what is in use exceed the limit: "<what> needs 5.2 GB beside the 0.4 GB
// in use, more than the limit of 4 GB; <advice>". Empty where they fit. `advice` says what would
// need less.
std::string MemoryShortage(double bytes, const std::string& what, const std::string& advice);

// Throws that as an InputError.
void RequireMemory(double bytes, const std::string& what, const std::string& advice);

}  // namespace lacuna

#endif  // LACUNA_CORE_MEMORY_LIMIT_H_
