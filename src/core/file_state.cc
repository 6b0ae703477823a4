#include "core/file_state.h"

#include <sys/stat.h>

namespace lacuna {
namespace {

int64_t Nanoseconds(const timespec& time) {
  return int64_t{1'000'000'000} * time.tv_sec + time.tv_nsec;
}

}  // namespace

FileState StateOf(const std::filesystem::path& file) {
  struct stat found {};
  if (stat(file.c_str(), &found) != 0) return {file};
  return {file, static_cast<uint64_t>(found.st_size), Nanoseconds(found.st_mtim),
          Nanoseconds(found.st_ctim)};
}

}  // namespace lacuna
