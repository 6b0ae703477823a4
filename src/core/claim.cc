#include "core/claim.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "core/error.h"
#include "core/file_lock.h"

namespace lacuna {
namespace {

std::string Self() {
  std::array<char, 256> host{};
  if (gethostname(host.data(), host.size() - 1) != 0) return fmt::format("process {}", getpid());
  return fmt::format("{}, process {}", host.data(), getpid());
}

}  // namespace

Claim::Claim(const std::filesystem::path& file)
    : descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666)) {
  const auto fail = [&](const char* what) {
    const int error = errno;
    if (descriptor_ >= 0) close(descriptor_);
    throw InputError({file.string()}, fmt::format("cannot be {}: {}", what, std::strerror(error)));
  };
  if (descriptor_ < 0) fail("written");
  holds_ = LockFile(descriptor_, /*wait=*/false);
  if (!holds_ && errno != EAGAIN && errno != EACCES) fail("locked");
  const std::string self = Self();
  if (holds_ && (ftruncate(descriptor_, 0) != 0 ||
                 write(descriptor_, self.data(), self.size()) != static_cast<ssize_t>(self.size())))
    fail("written");
}

Claim::~Claim() { close(descriptor_); }

std::string HolderOf(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  if (descriptor < 0) return "";
  std::string holder;
  if (IsLockedByAnother(descriptor)) {
    std::array<char, 512> text{};
    const ssize_t count = read(descriptor, text.data(), text.size());
    // The file is empty for a short time, because the name is written after the lock is acquired.
    holder = count > 0 ? std::string(text.data(), static_cast<size_t>(count)) : "another process";
  }
  close(descriptor);
  return holder;
}

}  // namespace lacuna
