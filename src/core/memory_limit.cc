#include "core/memory_limit.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

namespace lacuna {
namespace {

std::atomic<uint64_t> limit = 0;  // 0: none was set

std::string InWords(double bytes) {
  return bytes < 1e9 ? fmt::format("{:.0f} MB", 1e-6 * bytes)
                     : fmt::format("{:.1f} GB", 1e-9 * bytes);
}

uint64_t PageSize() { return static_cast<uint64_t>(sysconf(_SC_PAGESIZE)); }

}  // namespace

void SetMemoryLimit(uint64_t bytes) { limit = bytes; }

uint64_t MemoryLimit() {
  return limit > 0 ? limit.load() : PageSize() * static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES));
}

uint64_t MemoryInUse() {
  std::ifstream stream("/proc/self/statm");
  uint64_t whole = 0, resident = 0;
  stream >> whole >> resident;
  return PageSize() * resident;
}

void RequireMemory(double bytes, const std::string& what, const std::string& advice) {
  const double in_use = static_cast<double>(MemoryInUse());
  const double most = static_cast<double>(MemoryLimit());
  if (in_use + bytes <= most) return;
  throw OutOfMemory(fmt::format("{} needs {} beside the {} in use, more than the limit of {}; {}",
                                what, InWords(bytes), InWords(in_use), InWords(most), advice));
}

void ThrowIfOverMemoryLimit() {
  if (limit == 0) return;
  const double in_use = static_cast<double>(MemoryInUse());
  const double most = static_cast<double>(limit);
  if (in_use <= most) return;
  throw OutOfMemory(fmt::format("{} of memory are in use, more than the limit of {}; {}",
                                InWords(in_use), InWords(most), kCoarserMesh));
}

}  // namespace lacuna
