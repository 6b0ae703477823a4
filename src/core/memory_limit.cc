#include "core/memory_limit.h"

#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <fstream>

#include "core/error.h"

namespace lacuna {
namespace {

constexpr double kGigabyte = 1e9;

std::atomic<uint64_t> limit = 0;  // 0: none was set

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

std::string MemoryShortage(double bytes, const std::string& what, const std::string& advice) {
  const double in_use = static_cast<double>(MemoryInUse());
  const double most = static_cast<double>(MemoryLimit());
  if (in_use + bytes <= most) return "";
  return fmt::format(
      "{} needs {:.2g} GB beside the {:.2g} GB in use, more than the limit of {:.2g} GB; {}", what,
      bytes / kGigabyte, in_use / kGigabyte, most / kGigabyte, advice);
}

void RequireMemory(double bytes, const std::string& what, const std::string& advice) {
  const std::string shortage = MemoryShortage(bytes, what, advice);
  if (!shortage.empty()) throw InputError(shortage);
}

void ThrowIfOverMemoryLimit() {
  if (limit == 0) return;
  const double in_use = static_cast<double>(MemoryInUse());
  if (in_use <= static_cast<double>(limit)) return;
  throw InputError(
      fmt::format("{:.2g} GB of memory are in use, more than the limit of {:.2g} GB; {}",
                  in_use / kGigabyte, static_cast<double>(limit) / kGigabyte, kCoarserMesh));
}

}  // namespace lacuna
