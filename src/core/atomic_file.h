// Writing files atomically: a reader sees either the complete old content or the complete new one.
//
// The content is written to a temporary file in the same folder, which is flushed to the disk
// (fsync) and then renamed to its final name by rename(2). The guarantee also holds after a crash.
#ifndef LACUNA_CORE_ATOMIC_FILE_H_
#define LACUNA_CORE_ATOMIC_FILE_H_

#include <filesystem>
#include <string_view>

namespace lacuna {

// Replaces the content of `file`. The folder must exist. Throws InputError naming the file if it
// cannot be written; the old content is then unchanged.
void WriteFileAtomically(const std::filesystem::path& file, std::string_view content);

// Replaces the content of a file as WriteFileAtomically() does, for content that is produced in
// pieces: call Write as often as needed, then Commit once. Destroying the object without a Commit
// deletes the temporary file and leaves `file` unchanged.
class AtomicFile {
 public:
  // Follows a symbolic link. Throws InputError for a device, pipe or folder, and if the temporary
  // file cannot be created. Write and Commit throw InputError if the file cannot be written, for
  // example because the disk is full.
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

// Whether the path has the name of a temporary file of AtomicFile.
bool IsTemporaryFile(const std::filesystem::path& path);

// Removes the temporary files below `folder` that processes have left which were killed while they
// wrote. Files that a living process writes are locked and stay; a process on another machine is
// recognised only where the file system shares locks between machines. Nothing happens if the
// folder does not exist; what cannot be removed stays.
void RemoveLeftTemporaries(const std::filesystem::path& folder);

// Creates the folder and its parents if they do not exist. Throws InputError naming the folder if
// that fails or if the folder is not writable.
void MakeFolder(const std::filesystem::path& folder);

// Flushes the directory entries of `folder` to the disk, so that names that were created, renamed
// or removed in it survive a crash. Does nothing on file systems that do not support this.
void SyncFolder(const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_CORE_ATOMIC_FILE_H_
