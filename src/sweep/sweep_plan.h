// Lays out the cases of a sweep.
#ifndef LACUNA_SWEEP_SWEEP_PLAN_H_
#define LACUNA_SWEEP_SWEEP_PLAN_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "sweep/sweep_case.h"

namespace lacuna {

struct SweepPlan {
  std::vector<SweepCase> cases;     // all of the folder, by number
  int added = 0;                    // of them, now
  std::vector<std::string> absent;  // planned before, and no longer in the file; they stay
};

// Writes a folder for every case of the sweep file that has none yet, and cases.csv. A case keeps
// its name and its files for ever: its number and the hash of its experiment's name and changes.
// Everything is checked before anything is written. Throws InputError: told at the value of the
// sweep file that is wrong, if it is one; for a folder that holds something else or a sweep of
// another command; and for a case whose experiment would now have other contents than when it was
// planned.
SweepPlan PlanSweep(const Config& sweep_file, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_PLAN_H_
