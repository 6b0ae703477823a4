// The folder of a sweep, with a folder for each case that contains its experiment and its results.
//
//   <sweep>/sweep.json                     name and command
//   <sweep>/0001-1a2b3c4d/case.json        the experiment and the values changed in it
//   <sweep>/0001-1a2b3c4d/experiment.yaml  self-contained; for a table1 case experiments/*.yaml
//   <sweep>/0001-1a2b3c4d/claimed          locked by the process that works on the case
//   <sweep>/0001-1a2b3c4d/log.txt          the output of that process
//   <sweep>/0001-1a2b3c4d/run/             the results
//   <sweep>/0001-1a2b3c4d/outcome.json     written last
#ifndef LACUNA_SWEEP_SWEEP_CASE_H_
#define LACUNA_SWEEP_SWEEP_CASE_H_

#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sweep/sweep_command.h"

namespace lacuna {

struct CaseChange {
  std::string field;  // "mesh.max_volume"
  std::string value;  // YAML text
};

struct SweepCase {
  int number = 0;          // from 1
  std::string name;        // name of its folder: the number and a hash of the rest
  std::string experiment;  // path as written in the sweep file
  std::vector<CaseChange> changes;
  SweepSettings settings;
};
// The case in words, on one line: "bend.yaml with mesh.max_volume = 150 mm^3".
std::string Describe(const SweepCase& entry);

struct SweepIdentity {
  std::string name;
  SweepCommand command = SweepCommand::kReconstruct;
};

// The functions below write files atomically and throw InputError if that fails.

void WriteIdentity(const SweepIdentity& identity, const std::filesystem::path& folder);
// Throws InputError if the folder is not that of a sweep.
SweepIdentity ReadIdentity(const std::filesystem::path& folder);

void WriteCase(const SweepCase& entry, const std::filesystem::path& case_folder);
// All cases, sorted by number. Throws InputError for a damaged case.
std::vector<SweepCase> ReadCases(const std::filesystem::path& folder);

void WriteOutcome(const CaseOutcome& outcome, const std::filesystem::path& case_folder);
// The outcome; none if the case has not ended. Throws InputError for a damaged file.
std::optional<CaseOutcome> ReadOutcome(const std::filesystem::path& case_folder);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_CASE_H_
