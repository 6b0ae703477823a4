// The ledger of models: what was tried on the way from a fitted model to one of which no lack can
// be named any more, what each trial gained, and what it changed.
#ifndef LACUNA_DIAGNOSIS_LEDGER_H_
#define LACUNA_DIAGNOSIS_LEDGER_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration_record.h"
#include "diagnosis/diagnosis_record.h"

namespace lacuna {

// A fitted parameter against the same one of the model that this one was made from.
struct ParameterMove {
  std::string name, unit;
  bool added = false;  // the parent does not have it
  double before = 0, after = 0;
  double low = 0, high = 0;  // 95 % interval of `after`
  // The change, of the logarithm where it is searched on that scale, in the parent's deviations;
  // infinite where those are 0.
  double in_deviations = 0;
};

// One model that was fitted as a run of its own: a branch of the tree. The leaves beside it are the
// effects that its diagnosis refitted and that were not added.
struct LedgerModel {
  std::string name;                  // of the run
  std::filesystem::path run;         // its folder
  int parent = -1;                   // in Ledger::models; -1: the first model
  std::string added;                 // the effect that makes the difference to the parent
  CalibrationRecord record;          // usable or not
  ModelErrors errors;                // over all recordings; 0 where the fit is not usable
  double gain = 0;                   // share of the parent's held-out error (in σ) that went
  std::vector<ParameterMove> moves;  // against the parent
  std::optional<DiagnosisRecord> diagnosis;
};

struct Ledger {
  std::vector<LedgerModel> models;  // the first one, then as they were added
  std::string ending;               // why it ended, in words; empty: it has not yet
  bool usable = true;               // false: an added effect could not be fitted
  // The model with the least held-out error. There must be one.
  const LedgerModel& Best() const;
};

// Of all recordings together, as effect_refit.h has it of a model.
ModelErrors ErrorsOf(const CalibrationRecord& record);

// Parameters of `after`, those that it shares with `before` first as they stand in `after`.
std::vector<ParameterMove> MovesBetween(const CalibrationRecord& before,
                                        const CalibrationRecord& after);

// Errors, gain and moves are filled in from the record and the parent.
LedgerModel MakeLedgerModel(const Ledger& ledger, const std::filesystem::path& run,
                            const CalibrationRecord& record, int parent, const std::string& added);

// The tree in words, for 100 columns.
std::string LedgerInWords(const Ledger& ledger);

// ledger.json and ledger.txt in the folder; runs are named relative to it.
void SaveLedger(const Ledger& ledger, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_LEDGER_H_
