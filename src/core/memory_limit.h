// A limit on the memory of the process, so that what does not fit is refused before it is begun.
//
// The few large things of a computation, such as the factor of a stiffness matrix, are announced
// before they are allocated, and long loops watch what is in use. It is no limit of the operating
// system: under one (RLIMIT_DATA) OpenBLAS waits for ever for memory that it cannot get.
#ifndef LACUNA_CORE_MEMORY_LIMIT_H_
#define LACUNA_CORE_MEMORY_LIMIT_H_

#include <cstdint>
#include <string>

namespace lacuna {

// Sets the limit of this process and of those that it forks, bytes.
void SetMemoryLimit(uint64_t bytes);

// The limit, bytes: by default the machine's memory.
uint64_t MemoryLimit();

// What the process occupies now, bytes.
uint64_t MemoryInUse();

// Where `bytes` more than what is in use exceed the limit: "<what> needs 5.2 GB beside the 0.4 GB
// in use, more than the limit of 4 GB; <advice>". Empty where they fit. `advice` says what would
// need less.
std::string MemoryShortage(double bytes, const std::string& what, const std::string& advice);

// Throws that as an InputError.
void RequireMemory(double bytes, const std::string& what, const std::string& advice);

// Throws InputError where more is in use than a limit that was set. For loops whose turns take a
// millisecond or more.
void ThrowIfOverMemoryLimit();

// Advice for what grows with the mesh.
inline constexpr char kCoarserMesh[] =
    "larger elements (mesh.max_volume) or linear ones (mesh.order) need less";

}  // namespace lacuna

#endif  // LACUNA_CORE_MEMORY_LIMIT_H_
