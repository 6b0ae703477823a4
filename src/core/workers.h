// Running a list of jobs in several processes at the same time.
#ifndef LACUNA_CORE_WORKERS_H_
#define LACUNA_CORE_WORKERS_H_

#include <cstddef>
#include <functional>
#include <string>

namespace lacuna {

struct WorkerOptions {
  int workers = 1;  // number of processes at the same time
  int threads = 1;  // number of threads of each process
  // Called in the parent process if job k crashed or ended with an uncaught exception; the other
  // jobs continue. It is not called for a job that was stopped by a signal from another process,
  // because such a job has not failed and can be repeated.
  std::function<void(size_t k, const std::string& reason)> crashed = {};
};

// Calls job(k) for every k in [0, count), each in a separate process (fork), so that a crash does
// not affect the other jobs. Several calls, even on several machines, may work on the same list if
// each job claims its task (core/claim.h) and skips a task that is finished. After SIGINT or
// SIGTERM, no further job is started, and SIGTERM is sent to the running jobs. Returns whether all
// jobs were started and ended normally. Throws InputError if no process can be started. Call it
// before any thread has been started, since only the calling thread exists in a forked process.
bool RunInProcesses(size_t count, const WorkerOptions& options,
                    const std::function<void(size_t)>& job);

}  // namespace lacuna

#endif  // LACUNA_CORE_WORKERS_H_
