// A list of jobs, shared out to processes.
#ifndef LACUNA_CORE_WORKERS_H_
#define LACUNA_CORE_WORKERS_H_

#include <cstddef>
#include <functional>
#include <string>

namespace lacuna {

struct WorkerOptions {
  int workers = 1;  // processes at a time
  int threads = 1;  // of each
  // Told in the calling process when job k ended by a mistake of its own (a crash, an exception
  // that nobody caught); the others go on. Not told of one that was stopped from outside: it is to
  // be done again.
  std::function<void(size_t k, const std::string& reason)> crashed = {};
};

// Calls job(k) for every k in [0, count), each in a process of its own, so that a crash takes
// nothing else with it. Several calls, on several machines, may share a list: a job must claim what
// it works on and leave what is done. SIGINT and SIGTERM are passed on to the jobs, and no further
// one begins. Returns 0, or 1 when a job did not come to its end. Call it before threads have been
// started: a fork would lose them.
int ShareOut(size_t count, const WorkerOptions& options, const std::function<void(size_t)>& job);

}  // namespace lacuna

#endif  // LACUNA_CORE_WORKERS_H_
