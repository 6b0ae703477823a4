// The state of a file, by which a change of its content is noticed without reading it.
#ifndef LACUNA_CORE_FILE_STATE_H_
#define LACUNA_CORE_FILE_STATE_H_

#include <cstdint>
#include <filesystem>

namespace lacuna {

// What the file system says about a file. A change within the resolution of its clock, some
// milliseconds, that keeps the size is not seen.
struct FileState {
  std::filesystem::path file;
  uint64_t size = 0;
  // ns since 1970: when the content was changed, and when the content or the attributes were.
  int64_t modified = 0, changed = 0;
  bool operator==(const FileState&) const = default;
};

// Zeros for a file that does not exist.
FileState StateOf(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CORE_FILE_STATE_H_
