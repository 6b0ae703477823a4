#include "core/workers.h"

#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <exception>
#include <map>
#include <thread>

#include "core/error.h"
#include "core/interrupt.h"
#include "core/parallel.h"
#include "core/progress.h"

namespace lacuna {
namespace {

constexpr int kStopped = 3, kThrew = 4;  // exit statuses of a job's process
constexpr auto kPollInterval = std::chrono::milliseconds(10);

int Work(size_t k, int threads, const std::function<void(size_t)>& job) {
  // The kernel sends SIGTERM to the job if the parent process ends.
  prctl(PR_SET_PDEATHSIG, SIGTERM);
  RestartInterruptHandler();
  SetThreadCount(threads);
  try {
    job(k);
  } catch (const Interrupted&) {
    return kStopped;
  } catch (const std::exception& problem) {
    WriteLineToStandardError(problem.what());
    return kThrew;
  }
  return 0;
}

bool StoppedFromOutside(int status) {
  if (WIFEXITED(status)) {
    const int code = WEXITSTATUS(status);  // the sums: it did not stop within kStopGrace
    return code == kStopped || code == 128 + SIGINT || code == 128 + SIGTERM;
  }
  for (const int signal : {SIGKILL, SIGTERM, SIGINT, SIGHUP})
    if (WTERMSIG(status) == signal) return true;
  return false;
}

std::string HowItEnded(int status) {
  if (WIFSIGNALED(status))
    return fmt::format("its process ended by signal {} ({})", WTERMSIG(status),
                       strsignal(WTERMSIG(status)));
  return fmt::format("its process ended with status {}", WEXITSTATUS(status));
}

}  // namespace

bool RunInProcesses(size_t count, const WorkerOptions& options,
                    const std::function<void(size_t)>& job) {
  std::map<pid_t, size_t> running;
  size_t next = 0;
  bool failed = false, told = false;
  while (true) {
    while (next < count && static_cast<int>(running.size()) < options.workers &&
           !InterruptRequested()) {
      std::fflush(nullptr);  // otherwise the child would write buffered output again
      const pid_t child = fork();
      if (child == 0) {
        const int status = Work(next, options.threads, job);
        std::fflush(nullptr);
        _exit(status);
      }
      if (child < 0 && running.empty())
        throw InputError(fmt::format("cannot start a process: {}", std::strerror(errno)));
      if (child < 0) break;
      running[child] = next++;
    }
    if (running.empty()) break;
    if (InterruptRequested() && !told) {
      for (const auto& [child, k] : running) kill(child, SIGTERM);
      told = true;
    }
    for (auto at = running.begin(); at != running.end();) {
      int status = 0;
      if (waitpid(at->first, &status, WNOHANG) != at->first) {
        ++at;
        continue;
      }
      const bool done = WIFEXITED(status) && WEXITSTATUS(status) == 0;
      failed = failed || !done;
      if (!done && !StoppedFromOutside(status) && options.crashed)
        options.crashed(at->second, HowItEnded(status));
      at = running.erase(at);
    }
    if (!running.empty()) std::this_thread::sleep_for(kPollInterval);
  }
  return !failed && next == count;
}

}  // namespace lacuna
