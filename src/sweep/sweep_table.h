// What has come of the cases of a sweep, as a table.
#ifndef LACUNA_SWEEP_SWEEP_TABLE_H_
#define LACUNA_SWEEP_SWEEP_TABLE_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "sweep/sweep_case.h"

namespace lacuna {

enum class CaseStatus { kPlanned, kRunning, kDone, kFailed };
std::string NameOf(CaseStatus status);

struct SweepRow {
  SweepCase entry;
  CaseStatus status = CaseStatus::kPlanned;
  std::string note;                    // of a running case its process, of a failed one the reason
  std::optional<CaseOutcome> outcome;  // done or failed
};

struct SweepTable {
  SweepIdentity identity;
  std::vector<SweepRow> rows;  // by number

  int Count(CaseStatus status) const;
  // Neither done nor failed.
  int Unfinished() const { return Count(CaseStatus::kPlanned) + Count(CaseStatus::kRunning); }
};

// Reads the folder and changes nothing. Throws InputError.
SweepTable CollectSweep(const std::filesystem::path& folder);

// The varied values, the status and the first six numbers of each case; below it what is unfinished
// and why cases have failed.
std::string TableInWords(const SweepTable& table);
// table.txt, table.csv and table.json in the folder, with all numbers and words. The same outcomes
// give the same bytes.
void SaveTable(const SweepTable& table, const std::filesystem::path& folder);

// number,case,experiment and a column for each field that some case changes.
std::string CasesAsCsv(const std::vector<SweepCase>& cases);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_TABLE_H_
