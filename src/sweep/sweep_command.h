// What a case of a sweep can do: a command of the program, called as a function.
#ifndef LACUNA_SWEEP_SWEEP_COMMAND_H_
#define LACUNA_SWEEP_SWEEP_COMMAND_H_

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/progress.h"
#include "record/run_record.h"

namespace lacuna {

enum class SweepCommand {
  kReconstruct,  // lacuna reconstruct
  kFit,          // lacuna fit
  kOuterSearch,  // the search of one file of a table1 folder, from its own `seed`
  kTable1,       // lacuna table1
};
const std::vector<std::pair<std::string, SweepCommand>>& SweepCommands();
std::string NameOf(SweepCommand command);

// Of table1 cases (Table1Options).
struct SweepSettings {
  int seeds = 1;
  int turns = 0;
};

struct CaseOutcome {
  bool done = false;    // false: it failed, `message` says why
  std::string message;  // a failure's reason
  // In the order in which they are to be read; names end with the SI unit. NaN: not measured.
  std::vector<std::pair<std::string, double>> numbers;
  std::vector<std::pair<std::string, std::string>> words;
  double seconds = 0;  // of the process that ended the case
};

// File's name within the case's folder → its YAML.
using CaseFiles = std::map<std::string, std::string>;

// Reads the files as the command will, before they are written into `folder`. Throws InputError.
void CheckCase(SweepCommand command, const CaseFiles& files, const std::filesystem::path& folder);

// Runs the case that lies in `folder`, or goes on with it. Throws InputError and Interrupted; a
// numerical failure is an outcome that is not done.
CaseOutcome RunCommand(SweepCommand command, const SweepSettings& settings,
                       const std::filesystem::path& folder, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_COMMAND_H_
