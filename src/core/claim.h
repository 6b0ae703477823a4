// A lock on a file, by which processes agree who works on what.
//
// It is an open-file-description lock (fcntl(2), F_OFD_SETLK): the kernel drops it when its holder
// ends, however that happens, and over NFS it holds between machines, too.
#ifndef LACUNA_CORE_CLAIM_H_
#define LACUNA_CORE_CLAIM_H_

#include <filesystem>
#include <string>

namespace lacuna {

// Holds a file's lock until it goes out of scope. Where another one has it, holds() is false.
class Claim {
 public:
  // Makes the file where it is absent, and writes host and process into it when it gets the lock.
  // Throws InputError naming the file when it cannot be written, or cannot be locked where it lies.
  explicit Claim(const std::filesystem::path& file);
  ~Claim();
  Claim(const Claim&) = delete;
  Claim& operator=(const Claim&) = delete;
  bool holds() const { return holds_; }

 private:
  int descriptor_ = -1;
  bool holds_ = false;
};

// "host, process 123" of the claim that is held on this file; empty: none is. Takes no lock.
std::string HolderOf(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_CORE_CLAIM_H_
