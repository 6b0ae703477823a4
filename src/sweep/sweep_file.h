// The YAML file that describes a sweep (docs/sweep.md).
#ifndef LACUNA_SWEEP_SWEEP_FILE_H_
#define LACUNA_SWEEP_SWEEP_FILE_H_

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "core/config.h"
#include "sweep/sweep_case.h"

namespace lacuna {

struct RequestedChange {
  CaseChange change;
  // Throws InputError at the place of the sweep file where the value stands.
  std::function<void(const std::string& message)> refuse;
};

struct RequestedCase {
  std::string experiment;                // as the file names it
  std::filesystem::path path;            // of the experiment file, or of a table1 folder
  std::vector<RequestedChange> changes;  // by field
};

struct SweepFile {
  SweepIdentity identity;
  SweepSettings settings;
  std::vector<RequestedCase> cases;  // of each experiment: the grid, then the list
};

// Throws InputError: also for a field that is given no value or that a case sets itself (output),
// for the same case twice, and for a grid of more than 100 000 cases.
SweepFile ReadSweepFile(const Config& config);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_FILE_H_
