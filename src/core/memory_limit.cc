#include "core/memory_limit.h"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "core/error.h"

namespace lacuna {
namespace {

constexpr double kGigabyte = 1e9;

uint64_t PageSize() { return static_cast<uint64_t>(sysconf(_SC_PAGESIZE)); }

rlimit DataLimit() {
  rlimit data{RLIM_INFINITY, RLIM_INFINITY};
  getrlimit(RLIMIT_DATA, &data);
  return data;
}

}  // namespace

void SetMemoryLimit(uint64_t bytes) {
  rlimit data = DataLimit();
  data.rlim_cur = std::min<rlim_t>(bytes, data.rlim_max);
  setrlimit(RLIMIT_DATA, &data);
}

uint64_t MemoryLimit() {
  const uint64_t machine = PageSize() * static_cast<uint64_t>(sysconf(_SC_PHYS_PAGES));
  return std::min<uint64_t>(machine, DataLimit().rlim_cur);
}

uint64_t MemoryInUse() {
  std::ifstream stream("/proc/self/statm");
  uint64_t whole = 0, resident = 0, shared = 0, text = 0, library = 0, data = 0;
  stream >> whole >> resident >> shared >> text >> library >> data;
  return PageSize() * (DataLimit().rlim_cur == RLIM_INFINITY ? resident : data);
}

std::string MemoryShortage(double bytes, const std::string& what, const std::string& advice) {
  const double in_use = static_cast<double>(MemoryInUse());
  const double limit = static_cast<double>(MemoryLimit());
  if (in_use + bytes <= limit) return "";
  return fmt::format(
      "{} needs {:.2g} GB beside the {:.2g} GB in use, more than the limit of {:.2g} GB; {}", what,
      bytes / kGigabyte, in_use / kGigabyte, limit / kGigabyte, advice);
}

void RequireMemory(double bytes, const std::string& what, const std::string& advice) {
  const std::string shortage = MemoryShortage(bytes, what, advice);
  if (!shortage.empty()) throw InputError(shortage);
}

}  // namespace lacuna
