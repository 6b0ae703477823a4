#include "core/memory_limit.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

namespace lacuna {
namespace {

namespace fs = std::filesystem;

std::atomic<uint64_t> limit = 0;  // 0: none was set

std::string InWords(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", 1e-6 * bytes)
                     : fmt::format("{:.1f} GB", 1e-9 * bytes);
}

std::string InWords(const MemoryBound& bound) {
  return fmt::format("{}, {}", InWords(static_cast<double>(bound.bytes)), bound.origin);
}

uint64_t PageSize() { return static_cast<uint64_t>(sysconf(_SC_PAGESIZE)); }

void LowerTo(const fs::path& file, MemoryBound* bound) {
  std::ifstream stream(file);
  uint64_t bytes = 0;
  if (stream >> bytes && bytes < bound->bytes)
    *bound = {bytes, "set by the control group in " + file.string()};
}

// Lowers the bound to the limits of all groups from the root of a hierarchy down to `group`. Inside
// a container the root may be the container's own group, although /proc names it as seen from
// outside. The folders on the way down are then missing, and the limit of the root counts.
void LowerToGroups(const fs::path& root, const fs::path& group, const std::string& file,
                   MemoryBound* bound) {
  fs::path folder = root;
  LowerTo(folder / file, bound);
  for (const fs::path& name : group.relative_path()) {
    folder /= name;
    LowerTo(folder / file, bound);
  }
}

}  // namespace

void SetMemoryLimit(uint64_t bytes) { limit = bytes; }

uint64_t GivenMemoryLimit() { return limit; }

MemoryBound DefaultMemoryLimit(uint64_t machine, const fs::path& membership,
                               const fs::path& hierarchy) {
  MemoryBound bound{machine, "the machine's memory"};
  std::ifstream stream(membership);
  // Lines such as "4:cpu,memory:/group" (version 1) and "0::/group" (version 2).
  for (std::string line; std::getline(stream, line);) {
    const size_t first = line.find(':');
    const size_t second = first == std::string::npos ? first : line.find(':', first + 1);
    if (second == std::string::npos) continue;
    const std::string controllers = "," + line.substr(first + 1, second - first - 1) + ",";
    const std::string group = line.substr(second + 1);
    if (controllers == ",,") LowerToGroups(hierarchy, group, "memory.max", &bound);
    if (controllers.find(",memory,") != std::string::npos)
      LowerToGroups(hierarchy / "memory", group, "memory.limit_in_bytes", &bound);
  }
  return bound;
}

MemoryBound MemoryLimit() {
  if (const uint64_t bytes = GivenMemoryLimit()) return {bytes, "set with --memory-limit"};
  static const MemoryBound by_default =
      DefaultMemoryLimit(PageSize() * static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES)),
                         "/proc/self/cgroup", "/sys/fs/cgroup");
  return by_default;
}

uint64_t MemoryInUse() {
  std::ifstream stream("/proc/self/statm");
  uint64_t whole = 0, resident = 0;
  stream >> whole >> resident;
  return PageSize() * resident;
}

void RequireMemory(double bytes, const std::string& what, const std::string& advice) {
  const double in_use = static_cast<double>(MemoryInUse());
  const MemoryBound most = MemoryLimit();
  if (in_use + bytes <= static_cast<double>(most.bytes)) return;
  throw OutOfMemory(fmt::format("{} needs {} beside the {} in use, more than the limit of {}; {}",
                                what, InWords(bytes), InWords(in_use), InWords(most), advice));
}

void ThrowIfOverMemoryLimit() {
  if (limit == 0) return;
  const uint64_t in_use = MemoryInUse();
  const MemoryBound most = MemoryLimit();
  if (in_use <= most.bytes) return;
  throw OutOfMemory(fmt::format("{} of memory are in use, more than the limit of {}; {}",
                                InWords(static_cast<double>(in_use)), InWords(most), kCoarserMesh));
}

}  // namespace lacuna
