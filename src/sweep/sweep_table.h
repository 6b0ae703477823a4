// The results of all cases of a sweep as a table.
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
  std::string note;                    // process of a running case, or reason of a failure
  std::optional<CaseOutcome> outcome;  // present if the case is done or failed
};

struct SweepTable {
  SweepIdentity identity;
  std::vector<SweepRow> rows;  // sorted by case number

  int Count(CaseStatus status) const;
  // The number of cases that are neither done nor failed.
  int Unfinished() const { return Count(CaseStatus::kPlanned) + Count(CaseStatus::kRunning); }
};

// Reads the folder without changing it. Throws InputError if it is not a sweep or is damaged.
SweepTable CollectSweep(const std::filesystem::path& folder);

// A text table with the changed values, the status and the first six numbers of each case, followed
// by the unfinished cases and the reasons of failures.
std::string TableInWords(const SweepTable& table);
// Writes table.txt (as above), table.csv and table.json (with all numbers and words) into the
// folder. The same outcomes give the same bytes.
void WriteTable(const SweepTable& table, const std::filesystem::path& folder);

// A CSV table with the columns number, case and experiment and one for each field that some case
// changes.
std::string CasesAsCsv(const std::vector<SweepCase>& cases);

}  // namespace lacuna

#endif  // LACUNA_SWEEP_SWEEP_TABLE_H_
