// Writing files atomically: a reader sees the old content or the new one, never a part.
//
// The content goes to a temporary file in the same folder, is flushed to the disk (fsync) and takes
// the final name by rename(2). This holds after a crash, too.
#ifndef LACUNA_CORE_ATOMIC_FILE_H_
#define LACUNA_CORE_ATOMIC_FILE_H_

#include <filesystem>
#include <string_view>

namespace lacuna {

// Replaces the content of `file`. The folder must exist. Throws InputError naming the file if it
// cannot be written; the old content is then unchanged.
void WriteFileAtomically(const std::filesystem::path& file, std::string_view content);

// The same for content that is produced in pieces: call Write as often as needed, then Commit.
// Destroying the object without a Commit leaves no trace.
class AtomicFile {
 public:
  // Follows a symbolic link. Throws InputError for a device, pipe or folder, and if the temporary
  // file cannot be created. Write and Commit throw InputError if the disk refuses.
  explicit AtomicFile(const std::filesystem::path& file);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  void Write(std::string_view content);
  void Commit();

 private:
  [[noreturn]] void Fail(int error) const;

  std::filesystem::path file_;
  std::filesystem::path temporary_;
  int descriptor_ = -1;
};

// Creates the folder and its parents if they do not exist. Throws InputError naming the folder if
// that fails or if the folder is not writable.
void MakeFolder(const std::filesystem::path& folder);

// Flushes the entries of `folder` to the disk: names that were created, renamed or removed in it.
// Does nothing on file systems that cannot sync a folder.
void SyncFolder(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_CORE_ATOMIC_FILE_H_
