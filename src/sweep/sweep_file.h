// Reading of the YAML file that describes a sweep (docs/sweep.md).
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
  // Throws InputError with `message` at the position of the value in the sweep file.
  std::function<void(const std::string& message)> refuse;
};

struct RequestedCase {
  std::string experiment;                // path as written in the sweep file
  std::filesystem::path path;            // the experiment file, or the folder for table1
  std::vector<RequestedChange> changes;  // sorted by field
};

struct SweepFile {
  SweepIdentity identity;
  SweepSettings settings;
  std::vector<RequestedCase> cases;  // for each experiment the grid, then the listed cases
};

// Throws InputError with the position for invalid input, for example a field without values, a
// field that the sweep sets itself (output, use), a repeated case, or a grid of more than 100 000
// cases.
SweepFile ReadSweepFile(const Config& config);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_FILE_H_
