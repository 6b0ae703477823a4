// Runs the diagnosis of a fitted run, keeps it in <run>/diagnosis, and reads it back where it
// belongs to the fit that stands there.
#ifndef LACUNA_DIAGNOSIS_DIAGNOSIS_RUN_H_
#define LACUNA_DIAGNOSIS_DIAGNOSIS_RUN_H_

#include <filesystem>
#include <optional>
#include <string>

#include "calibration/calibration_run.h"
#include "core/progress.h"
#include "diagnosis/decision_input.h"
#include "diagnosis/diagnosis.h"
#include "record/diagnosis_record.h"

namespace lacuna {

// diagnosis.json, and of_fit.json, which tells what fit it is of and how each effect of its ranking
// was set up. One that is there is read back when fit, options and files are still the same.
// Leaves the effects of `fitted` at the fitted values. Throws InputError and Interrupted.
DiagnosisRecord RunDiagnosis(const FittedRun& fitted, const std::filesystem::path& run,
                             const DiagnosisOptions& options, Progress* progress);

// Whether RunDiagnosis would read one back.
bool IsDiagnosed(const std::filesystem::path& run, const DiagnosisOptions& options);

// A diagnosis that was read back, with what its decision was made from.
struct KeptDiagnosis {
  DiagnosisRecord record;
  DecisionInput decision;
};
// The diagnosis of the fit that stands in this folder, with whatever options; nothing where there
// is none. Throws InputError when its files cannot be read.
std::optional<KeptDiagnosis> FindDiagnosis(const std::filesystem::path& run);

// An effect of the ranking that RunDiagnosis left in this folder, where its refit ended, or as
// first order expects it. Throws InputError when it is not there.
ScoredEffect DiagnosedEffect(const FittedRun& fitted, const std::filesystem::path& run,
                             const RecordedEffect& effect);

// DiagnosedEffect() for the effect of this type in a diagnosis of this fit with whatever options;
// nothing where none has the effect.
std::optional<ScoredEffect> FindDiagnosed(const FittedRun& fitted, const std::filesystem::path& run,
                                          const std::string& type);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DIAGNOSIS_RUN_H_
