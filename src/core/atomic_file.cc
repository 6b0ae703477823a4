#include "core/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>
#include <system_error>
#include <vector>

#include "core/error.h"
#include "core/file_lock.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// The count makes the name unique among the threads of this process, and the process id makes it
// unique among the processes of this machine.
fs::path TemporaryName(const fs::path& file) {
  static std::atomic<unsigned> count{0};
  return file.parent_path() / ("." + file.filename().string() + "." + std::to_string(getpid()) +
                               "." + std::to_string(count++) + ".tmp");
}

// Whether the open file has no name any more.
bool IsUnlinked(int descriptor) {
  struct stat status {};
  return fstat(descriptor, &status) == 0 && status.st_nlink == 0;
}

fs::path FolderOf(const fs::path& file) {
  return file.has_parent_path() ? file.parent_path() : fs::path(".");
}

}  // namespace

AtomicFile::AtomicFile(const fs::path& file) : file_(file) {
  std::error_code error;
  if (fs::is_symlink(file_, error)) {
    const fs::path target = fs::weakly_canonical(file_, error);
    if (!error) file_ = target;
  }
  // Renaming a file to the name of a device or a pipe would replace the device or pipe.
  if (fs::exists(file_, error) && !fs::is_regular_file(file_, error)) {
    throw InputError({file.string()}, "cannot be written: it is not an ordinary file");
  }
  // Between open and lock another process may take the file for an abandoned one and remove it;
  // then a new one is made.
  // On a file system without locks the file stays unlocked, and RemoveLeftTemporaries leaves it.
  constexpr int kAttempts = 5;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    if (descriptor_ >= 0) close(descriptor_);
    temporary_ = TemporaryName(file_);
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0) Fail(errno);
    // The lock ends with this process, so that a temporary file whose lock is free was left by one
    // that is gone.
    LockFile(descriptor_, /*wait=*/true);
    if (!IsUnlinked(descriptor_)) return;
  }
}

AtomicFile::~AtomicFile() {
  if (descriptor_ < 0) return;
  close(descriptor_);
  unlink(temporary_.c_str());
}

void AtomicFile::Write(std::string_view content) {
  while (!content.empty()) {
    const ssize_t written = write(descriptor_, content.data(), content.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) Fail(errno);
    content.remove_prefix(static_cast<size_t>(written));
  }
}

void AtomicFile::Commit() {
  if (fsync(descriptor_) != 0) Fail(errno);
  // The lock ends with close; until then nobody takes the file for a left one.
  if (rename(temporary_.c_str(), file_.c_str()) != 0) Fail(errno);
  close(descriptor_);
  descriptor_ = -1;
  SyncFolder(FolderOf(file_));
}

void AtomicFile::Fail(int error) const {
  throw InputError({file_.string()}, std::string("cannot be written: ") + std::strerror(error));
}

void WriteFileAtomically(const fs::path& file, std::string_view content) {
  AtomicFile output(file);
  output.Write(content);
  output.Commit();
}

bool IsTemporaryFile(const fs::path& path) {
  // ".NAME.PROCESS.COUNT.tmp"
  const std::string name = path.filename().string();
  if (!name.starts_with(".") || path.extension() != ".tmp") return false;
  fs::path rest = path.stem();
  for (int number = 0; number < 2; ++number, rest = rest.stem()) {
    const std::string digits = rest.extension().string();
    if (digits.size() < 2 || digits.find_first_not_of("0123456789", 1) != std::string::npos)
      return false;
  }
  return rest.string().size() > 1;
}

void RemoveLeftTemporaries(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> found;
  for (auto entry = fs::recursive_directory_iterator(folder, error);
       !error && entry != fs::recursive_directory_iterator(); entry.increment(error))
    if (IsTemporaryFile(entry->path()) && entry->is_regular_file(error))
      found.push_back(entry->path());
  for (const fs::path& file : found) {
    const int descriptor = open(file.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (LockFile(descriptor, /*wait=*/false)) unlink(file.c_str());
    close(descriptor);
  }
}

void MakeFolder(const std::filesystem::path& folder) {
  std::error_code problem;
  std::filesystem::create_directories(folder, problem);
  if (problem) throw InputError({folder.string()}, "cannot be created: " + problem.message());
  if (access(folder.c_str(), W_OK | X_OK) != 0)
    throw InputError({folder.string()}, "cannot be written to");
}

void SyncFolder(const fs::path& folder) {
  const int descriptor = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (descriptor < 0) return;
  // The result is ignored: some file systems cannot flush a folder, and the rename is atomic there,
  // too.
  fsync(descriptor);
  close(descriptor);
}

}  // namespace lacuna
