// Running a list of jobs in several processes at a time.
#ifndef LACUNA_CORE_WORKERS_H_
#define LACUNA_CORE_WORKERS_H_

#include <cstddef>
#include <functional>
#include <string>

namespace lacuna {

struct WorkerOptions {
  int workers = 1;  // processes at a time
  int threads = 1;  // threads of each process
  // Called in the parent process if job k crashed or ended with an uncaught exception; the other
  // jobs continue. Not called for a job that was stopped by a signal from outside, which should
  // simply be done again.
  std::function<void(size_t k, const std::string& reason)> crashed = {};
};

// Calls job(k) for every k in [0, count), each in a process of its own (fork), so that a crash does
// not affect the others. Several calls, also on several machines, may work on the same list if each
// job claims its task (core/claim.h) and skips a finished one. SIGINT and SIGTERM are passed on to
// the running jobs, and no further job is started. Returns 0 if all jobs ended normally, else 1.
// Throws InputError if no process can be started. Call it before any thread has been started, since
// a forked process has only one.
int ShareOut(size_t count, const WorkerOptions& options, const std::function<void(size_t)>& job);

}  // namespace lacuna

#endif  // LACUNA_CORE_WORKERS_H_
