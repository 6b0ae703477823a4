// Files that are either whole or not there.
//
// The content goes to a temporary file in the same folder, is flushed to the disk and takes the
// final name by rename(2). A reader, or a run after a crash, sees the old content or the new one,
// never a part.
#ifndef LACUNA_CORE_ATOMIC_FILE_H_
#define LACUNA_CORE_ATOMIC_FILE_H_

#include <filesystem>
#include <string_view>

namespace lacuna {

// Replaces `file` by `content`. The folder must exist. Throws InputError naming the file when it
// cannot be written; the old content then stands.
void WriteFileAtomically(const std::filesystem::path& file, std::string_view content);

// The same for content that comes in pieces: Write as often as needed, then Commit. Without a
// Commit nothing is left behind.
class AtomicFile {
 public:
  // A symbolic link is followed; a device, pipe or folder is refused with InputError.
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

// Makes the folder, and those above it, where they are not there. Throws InputError naming it when
// that cannot be done or nothing can be written into it.
void MakeFolder(const std::filesystem::path& folder);

// Asks the disk to hold the entries of `folder`: names created, renamed or removed in it.
void SyncFolder(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_CORE_ATOMIC_FILE_H_
