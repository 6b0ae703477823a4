// Diagnoses a fitted model, adds the missing effect, fits again and diagnoses the new model, until
// no effect can be named any more. An effect that explains most of the misfit is added even where
// the verdict is "not in library" (PartlyExplainedBy, record/diagnosis_record.h): with it in the
// model, the rest of the residual can be seen better.
#ifndef LACUNA_DIAGNOSIS_EXTENSION_ROUNDS_H_
#define LACUNA_DIAGNOSIS_EXTENSION_ROUNDS_H_

#include <filesystem>
#include <functional>

#include "core/progress.h"
#include "diagnosis/diagnosis.h"
#include "record/ledger.h"

namespace lacuna {

struct ExtensionOptions {
  DiagnosisOptions diagnosis;
  int most_effects = 8;      // the largest number of effects that are added; more: slower
  bool follow_best = false;  // true: after an ambiguous verdict, add the best; false: stop there
  // The search ends when an added effect does not lower the held-out error by more than this share
  // (LowersError). Higher: it ends earlier, also after an effect that is small or that another
  // parameter has compensated for.
  double least_gain = 0;
};

// Starts from the finished fit in `run`. ledger.json and ledger.txt in that folder are written anew
// after each diagnosis and each fit, and on_change sees the ledger then. Further runs lie beside
// that folder (WriteExtendedExperiment); fits and diagnoses that exist already are read back. The
// search ends for one of the reasons in LedgerEnding. Throws InputError and Interrupted; the ledger
// on disk then shows what was done.
Ledger ExtendUntilDone(const std::filesystem::path& run, const ExtensionOptions& options,
                       Progress* progress, const std::function<void(const Ledger&)>& on_change);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EXTENSION_ROUNDS_H_
