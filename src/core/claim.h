// A lock on a file, by which processes agree which of them works on a task.
//
// It is an open-file-description lock (fcntl(2), F_OFD_SETLK): the kernel releases it when its
// holder ends, even by a crash, and over NFS it also works between machines.
#ifndef LACUNA_CORE_CLAIM_H_
#define LACUNA_CORE_CLAIM_H_

#include <filesystem>
#include <string>

namespace lacuna {

// Holds the lock of a file until it is destroyed. holds() is false if another process has it.
class Claim {
 public:
  // Tries to take the lock without waiting. Creates the file if it is absent, and on success writes
  // host and process into it. Throws InputError naming the file if it cannot be written or if its
  // file system does not support locks.
  explicit Claim(const std::filesystem::path& file);
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  bool holds() const { return holds_; }

 private:
  int descriptor_ = -1;
  bool holds_ = false;
};

// The holder of the lock on `file`, as "host, process 123"; empty if nobody holds it. Takes no
// lock.
std::string HolderOf(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CORE_CLAIM_H_
