#include "trials/workers.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/wait.h>
#include <unistd.h>

#include <vector>

#include "core/interrupt.h"
#include "core/parallel.h"

namespace lacuna {
namespace {

int Work(size_t count, const std::function<void(size_t)>& job) {
  SetThreadCount(1);
  try {
    for (size_t k = 0; k < count; ++k) job(k);
  } catch (const Interrupted&) {
    return 1;
  }
  return 0;
}

}  // namespace

Claim::Claim(const std::filesystem::path& file)
    : descriptor_(open(file.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0644)) {
  holds_ = descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) == 0;
}

Claim::~Claim() {
  if (descriptor_ >= 0) close(descriptor_);
}

int ShareOut(size_t count, int workers, const std::function<void(size_t)>& job) {
  std::vector<pid_t> children;
  for (int worker = 1; worker < workers; ++worker) {
    const pid_t child = fork();
    if (child == 0) _exit(Work(count, job));
    if (child > 0) children.push_back(child);
  }
  int failed = Work(count, job);
  for (const pid_t child : children) {
    int status = 0;
    waitpid(child, &status, 0);
    failed |= !(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  }
  return failed;
}

}  // namespace lacuna
