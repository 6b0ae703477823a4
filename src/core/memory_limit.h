// A limit on the memory of the process, so that what does not fit is refused before it is begun.
//
// Meshes and the factors of stiffness matrices are announced before they are allocated, and the
// time steps of predictions and reconstructions watch what is in use. What several threads announce
// at the same time is not added up. It is no limit of the operating system: under one (RLIMIT_DATA)
// OpenBLAS waits for ever for memory that it cannot get.
#ifndef LACUNA_CORE_MEMORY_LIMIT_H_
#define LACUNA_CORE_MEMORY_LIMIT_H_

#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>

namespace lacuna {

// Thrown where a computation would exceed the limit. It is not an InputError: code that catches
// those, and takes the input for unusable, must not catch it, since the same input can be used with
// more memory.
class OutOfMemory : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// Sets the limit of this process and of those that it forks, bytes.
void SetMemoryLimit(uint64_t bytes);

// The limit that was set, bytes; 0 if none was.
uint64_t GivenMemoryLimit();

// A limit, and where it comes from.
struct MemoryBound {
  uint64_t bytes = 0;
  std::string origin;  // in words that follow "the limit of 4.0 GB, "
};

// The limit that was set or, if none was, DefaultMemoryLimit of this machine and process, which is
// determined once.
MemoryBound MemoryLimit();

// The lowest of the machine's memory (bytes) and the limits of the control group (cgroups(7)) that
// the process belongs to and of all groups that contain it. Containers, units of systemd and jobs
// of batch systems run in such groups, and the kernel kills what exceeds their limits. `membership`
// is a file like /proc/self/cgroup, and `hierarchy` a folder like /sys/fs/cgroup. The limits are
//   <hierarchy>/<group>/memory.max                      of version 2, and
//   <hierarchy>/memory/<group>/memory.limit_in_bytes    of version 1.
// A file that cannot be read, or that contains no number (for example "max"), sets no limit.
MemoryBound DefaultMemoryLimit(uint64_t machine, const std::filesystem::path& membership,
                               const std::filesystem::path& hierarchy);

// What the process occupies now, bytes.
uint64_t MemoryInUse();

// Throws OutOfMemory where `bytes` more than what is in use exceed the limit: "<what> needs 5.2 GB
// beside the 400 MB in use, more than the limit of 4.0 GB, set with --memory-limit; <advice>".
// `advice` says what would need less.
void RequireMemory(double bytes, const std::string& what, const std::string& advice);

// Throws OutOfMemory where more is in use than a limit that was set. For loops whose turns take a
// millisecond or more.
void ThrowIfOverMemoryLimit();

// Advice for what grows with the mesh.
inline constexpr char kCoarserMesh[] =
    "larger elements (mesh.max_volume) or linear ones (mesh.order) need less";

}  // namespace lacuna

#endif  // LACUNA_CORE_MEMORY_LIMIT_H_
