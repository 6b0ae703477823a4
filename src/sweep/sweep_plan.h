// Planning of a sweep: creation of the folders of its cases.
#ifndef LACUNA_SWEEP_SWEEP_PLAN_H_
#define LACUNA_SWEEP_SWEEP_PLAN_H_

#include <filesystem>
#include <string>
#include <vector>

#include "core/config.h"
#include "sweep/sweep_case.h"

namespace lacuna {

struct SweepPlan {
  std::vector<SweepCase> cases;     // all cases in the folder, by number
  int added = 0;                    // number of cases that this call has added
  std::vector<std::string> absent;  // cases planned earlier that are no longer in the file
};

// Writes cases.csv and a folder for each case of the sweep file that has none yet. A case never
// changes its files or its name, which consists of its number and the hash of its experiment's name
// and changes. Everything is checked before anything is written. Throws InputError for a bad case,
// if possible at the position of the wrong value in the sweep file; for a folder that contains
// something else or a sweep of another command; and if the contents of an experiment have changed
// since its case was planned.
SweepPlan PlanSweep(const Config& sweep_file, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_PLAN_H_
