// Running the cases of a sweep that have no outcome yet.
#ifndef LACUNA_SWEEP_SWEEP_RUN_H_
#define LACUNA_SWEEP_SWEEP_RUN_H_

#include <filesystem>
#include <vector>

namespace lacuna {

struct SweepRunOptions {
  int workers = 1;                // number of simultaneous processes, one case each
  int threads = 1;                // threads of each process; results do not depend on it
  std::vector<int> numbers = {};  // numbers of the cases to run; all if empty
  bool retry_failed = false;      // run failed cases again
};

// Runs the cases, each in a process of its own. Several calls, also on machines that share the
// folder, divide the cases among themselves: a process claims a case by a lock, which is released
// when the process ends. A case resumes from its earlier results; its outcome is written last. A
// case that does not fit into memory (core/memory_limit.h) gets none, since another machine may be
// able to run it. The end of each case is reported by a line on standard error. Returns the number
// of cases that are not done. Throws InputError, and Interrupted after a signal.
int RunSweep(const std::filesystem::path& folder, const SweepRunOptions& options);

// The numbers of the cases that RunSweep would run with these options. Throws InputError if one of
// options.numbers does not exist.
std::vector<int> UnfinishedCases(const std::filesystem::path& folder,
                                 const SweepRunOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_RUN_H_
