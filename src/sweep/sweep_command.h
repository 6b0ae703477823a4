// The commands that the cases of a sweep can run, called as functions.
#ifndef LACUNA_SWEEP_SWEEP_COMMAND_H_
#define LACUNA_SWEEP_SWEEP_COMMAND_H_

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "record/calibration_record.h"
#include "record/run_record.h"

namespace lacuna {

enum class SweepCommand {
  kReconstruct,  // lacuna reconstruct
  kFit,          // lacuna fit
  kOuterSearch,  // the parameter search of one file of a table1 folder, with the file's own `seed`
  kTable1,       // lacuna table1
};
// All commands with their names in the sweep file.
const std::vector<std::pair<std::string, SweepCommand>>& SweepCommands();
std::string NameOf(SweepCommand command);

// Settings of table1 cases (see Table1Options).
struct SweepSettings {
  int seeds = 1;
  int turns = 0;
};

struct CaseOutcome {
  bool done = false;    // false if the case failed
  std::string message;  // the reason for a failure
  // Results in the order of the table's columns. Names end with the SI unit; NaN where not
  // measured.
  std::vector<std::pair<std::string, double>> numbers;
  std::vector<std::pair<std::string, std::string>> words;
  double seconds = 0;  // wall time of the process that finished the case
};

// The outcome of a reconstruction: its residuals, the size of its mesh, the frames that could not
// be followed, and all measures of its record.
CaseOutcome OutcomeOf(const RunRecord& record);
// The outcome of a fit: its residuals, and of each parameter the value, the value with infinitely
// fine elements and time steps (FittedParameter::at_limit), the 95 % interval of the latter, and as
// a word its verdict.
CaseOutcome OutcomeOf(const CalibrationRecord& record);

// The files of a case: name within its folder → YAML.
using CaseFiles = std::map<std::string, std::string>;

// Reads the files as the command does, before they are written into `folder`. Throws InputError
// if the command would refuse them.
void CheckCase(SweepCommand command, const CaseFiles& files, const std::filesystem::path& folder);

// Runs or resumes the case in `folder`. Throws InputError for bad input, Interrupted, and
// OutOfMemory (core/memory_limit.h) or std::bad_alloc for a case that does not fit into the memory
// of this machine; a numerical failure gives an outcome that is not done.
CaseOutcome RunCommand(SweepCommand command, const SweepSettings& settings,
                       const std::filesystem::path& folder, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_COMMAND_H_
