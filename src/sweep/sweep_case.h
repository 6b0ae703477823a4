// A sweep's folder: one folder a case, with its own experiment and what came of it.
//
//   <sweep>/sweep.json                     name and command
//   <sweep>/0001-1a2b3c4d/case.json        which experiment, and what was changed in it
//   <sweep>/0001-1a2b3c4d/experiment.yaml  complete; of a table1 case: experiments/*.yaml
//   <sweep>/0001-1a2b3c4d/claimed          locked by the process that works on it
//   <sweep>/0001-1a2b3c4d/log.txt          what that process said
//   <sweep>/0001-1a2b3c4d/run/             its results
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
  std::string value;  // YAML
};

struct SweepCase {
  int number = 0;          // from 1
  std::string name;        // of its folder: the number and a hash of what follows
  std::string experiment;  // as the sweep file names it
  std::vector<CaseChange> changes;
  SweepSettings settings;
};
// "bend.yaml with mesh.max_volume = 150 mm^3"
std::string Describe(const SweepCase& entry);

struct SweepIdentity {
  std::string name;
  SweepCommand command = SweepCommand::kReconstruct;
};

void SaveIdentity(const SweepIdentity& identity, const std::filesystem::path& folder);
// Throws InputError where the folder is no sweep's.
SweepIdentity LoadIdentity(const std::filesystem::path& folder);

void SaveCase(const SweepCase& entry, const std::filesystem::path& case_folder);
// All cases, by number. Throws InputError for a damaged one.
std::vector<SweepCase> LoadCases(const std::filesystem::path& folder);

void SaveOutcome(const CaseOutcome& outcome, const std::filesystem::path& case_folder);
// Nothing where the case has not ended. Throws InputError for a damaged file.
std::optional<CaseOutcome> LoadOutcome(const std::filesystem::path& case_folder);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_CASE_H_
