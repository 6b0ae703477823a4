// The ledger of models as plain data: ledger.json in the folder of the first run.
//
// It lists the models from a first fit to one for which no missing effect can be named: how much
// each added effect reduced the error, which parameters it changed, and what else was tried.
#ifndef LACUNA_RECORD_LEDGER_H_
#define LACUNA_RECORD_LEDGER_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "record/calibration_record.h"
#include "record/diagnosis_record.h"

namespace lacuna {

// A fitted parameter compared with the same parameter of the parent model. Values are in SI units.
struct ParameterMove {
  std::string name, unit;
  bool added = false;  // whether the parent model lacks it
  double before = 0, after = 0;
  double low = 0, high = 0;  // 95 % interval of `after`
  // The change in posterior standard deviations of the parent (DeviationsTo); infinite where those
  // are 0.
  double in_deviations = 0;
};

// One model, fitted as a run of its own. The models form a tree; effects that a model's diagnosis
// refitted, and that were not added to it, are its leaves.
struct LedgerModel {
  std::string name;           // name of the run
  std::filesystem::path run;  // its folder
  int parent = -1;            // index in Ledger::models; -1 for the first model
  std::string added;          // the effect that the parent does not have
  CalibrationRecord record;   // usable or not
  ModelErrors errors;         // over all recordings; 0 if the fit is not usable
  double gain = 0;            // relative reduction of the parent's held-out error (in σ)
  // Relative reduction of the parent's held-out error with the points at the places where they were
  // measured (in m).
  double gain_at_measured_places = 0;
  // Relative reduction of the parent's error (in σ) over the measured values of all kinds: those of
  // points and of forces and torques. The same as `gain` where no force is measured.
  double gain_with_reactions = 0;
  std::vector<ParameterMove> moves;  // changes from the parent
  bool may_be_zero = false;          // as SizeMayBeZero says of the added effect
  std::optional<DiagnosisRecord> diagnosis;
};

// Why no further effect was added.
struct LedgerEnding {
  enum class Reason {
    kNone,         // the search has not ended
    kVerdict,      // the last verdict names no effect to add
    kUndecided,    // the last verdict is ambiguous, and no effect is added by guess
    kMostEffects,  // as many effects were added as allowed
    kNotFitted,    // the last added effect could not be fitted
    kLittleGain,   // the last added effect does not lower the error by more than `least_gain`
    kMayBeZero,    // the size of the last added effect may be zero
  };
  Reason reason = Reason::kNone;
  double least_gain = 0;  // threshold of kLittleGain
};

struct Ledger {
  std::vector<LedgerModel> models;  // in the order in which they were added
  LedgerEnding ending;

  bool HasEnded() const { return ending.reason != LedgerEnding::Reason::kNone; }
  // False if an added effect could not be fitted.
  bool IsUsable() const { return ending.reason != LedgerEnding::Reason::kNotFitted; }
  // The model that the effects which count lead to: each of them is fitted, lowers the error
  // (LowersError) and has a size that cannot be zero. At least one model is needed (CHECK).
  const LedgerModel& Best() const;
  // The effects that lead to Best() and whose size may be zero in its fit: later ones explain what
  // these seemed to explain when they were added.
  std::vector<std::string> MayBeLeftOut() const;
};

// Whether the 95 % intervals of all parameters that make the size of the effect `added`, which
// include the error of the elements, contain 0 in a fit with it. `before`: the diagnosis that has
// ranked it. False where the fit is not usable or there is no such parameter.
bool SizeMayBeZero(const CalibrationRecord& record, const DiagnosisRecord& before,
                   const std::string& added);

// Whether a model's error is smaller than its parent's by more than this share: the held-out error
// of the points, the error with measured forces and torques or, where the first stays the same to
// 2 %, the held-out error with the points at the places where they were measured. Places that are
// fitted within their uncertainty may hide a deformation that the parent lacks, and so may grips
// that prescribe the motion, of which only the force tells what is missing.
bool LowersError(const LedgerModel& model, double share);

// The errors over all recordings of a fit.
ModelErrors ErrorsOf(const CalibrationRecord& record);

// The parameters of `after`, compared with those of `before` that have the same name.
std::vector<ParameterMove> MovesBetween(const CalibrationRecord& before,
                                        const CalibrationRecord& after);

// The model of this run, with errors, gain and moves computed from the record and the parent.
LedgerModel MakeLedgerModel(const Ledger& ledger, const std::filesystem::path& run,
                            const CalibrationRecord& record, int parent, const std::string& added);

// Writes <folder>/ledger.json, in which runs are named relative to the folder.
void WriteLedgerFile(const Ledger& ledger, const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_RECORD_LEDGER_H_
