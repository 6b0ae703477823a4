// Runs the cases of a sweep that have no outcome yet.
#ifndef LACUNA_SWEEP_SWEEP_RUN_H_
#define LACUNA_SWEEP_SWEEP_RUN_H_

#include <filesystem>
#include <vector>

namespace lacuna {

struct SweepRunOptions {
  int workers = 1;                // processes at a time, one case each
  int threads = 1;                // of each; results do not depend on it
  std::vector<int> numbers = {};  // of the cases to run; empty: all
  bool retry_failed = false;      // failed cases, too
};

// Several calls, on several machines that share the folder, divide the cases among themselves: each
// is claimed by a lock that its process loses when it ends. A case goes on from what it has; its
// outcome is written last. A line on standard error tells the end of each. Returns how many of the
// cases have not ended well. Throws InputError, and Interrupted when it was asked to stop.
int RunSweep(const std::filesystem::path& folder, const SweepRunOptions& options);

// Numbers of the cases that a call with these options would run. Throws InputError where one of
// options.numbers is no case.
std::vector<int> UnfinishedCases(const std::filesystem::path& folder,
                                 const SweepRunOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_RUN_H_
