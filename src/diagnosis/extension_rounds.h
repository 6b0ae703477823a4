// Diagnose, add what is missing, fit, and diagnose again, until no effect can be named any more.
#ifndef LACUNA_DIAGNOSIS_EXTENSION_ROUNDS_H_
#define LACUNA_DIAGNOSIS_EXTENSION_ROUNDS_H_

#include <filesystem>
#include <functional>

#include "core/progress.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/ledger.h"

namespace lacuna {

struct ExtensionOptions {
  DiagnosisOptions diagnosis;
  int most_effects = 8;      // added one after another; more: longer
  bool follow_best = false;  // of an ambiguous verdict, add the best; false: stop there
  // Share of the held-out error that an added effect must take away for the search to go on; more:
  // it ends earlier.
  double least_gain = 0.02;
};

// From the finished fit in `run`. Keeps the ledger in that folder (SaveLedger), written anew after
// every diagnosis and every fit, which on_change then sees; further runs lie beside that folder
// (WriteExtendedExperiment). What of all this is there already is read back. It ends when a verdict
// is not "missing" (or "ambiguous", with follow_best), when an added effect cannot be fitted or
// gains too little, and after most_effects. Throws InputError and Interrupted; the ledger then
// tells what was done.
Ledger ExtendUntilDone(const std::filesystem::path& run, const ExtensionOptions& options,
                       Progress* progress, const std::function<void(const Ledger&)>& on_change);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EXTENSION_ROUNDS_H_
