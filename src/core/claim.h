// A lock on a file, which ensures that only one process works on a task.
//
// It is an open-file-description lock (fcntl(2), F_OFD_SETLK): the kernel releases it when the
// process that holds it ends, even by a crash, and over NFS it also works between machines.
#ifndef LACUNA_CORE_CLAIM_H_
#define LACUNA_CORE_CLAIM_H_

#include <filesystem>
#include <string>

namespace lacuna {

// Holds the lock of a file during the lifetime of the object. holds() is false if another process
// holds the lock.
class Claim {
 public:
  // Tries to acquire the lock without waiting. Creates the file if it is absent, and on success
  // writes the host name and the process id to it. Throws InputError naming the file if it cannot
  // be written or if its file system does not support locks.
  explicit Claim(const std::filesystem::path& file);
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  bool holds() const { return holds_; }

 private:
  int descriptor_ = -1;
  bool holds_ = false;
};

// The process that holds the lock on `file`, as "host, process 123"; empty if none does or if the
// file cannot be read. Does not acquire the lock.
std::string HolderOf(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CORE_CLAIM_H_
