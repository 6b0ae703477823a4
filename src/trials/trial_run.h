// Diagnoses sealed cases, and keeps what came of each beside it.
#ifndef LACUNA_TRIALS_TRIAL_RUN_H_
#define LACUNA_TRIALS_TRIAL_RUN_H_

#include <filesystem>
#include <string>
#include <vector>

#include "record/verdict.h"
#include "trials/trial_case.h"

namespace lacuna {

// What a diagnosis made of a case, and how its hidden effect fared when it was fitted.
struct TrialOutcome {
  Verdict verdict = Verdict::kNoPower;
  std::vector<std::string> named;  // effects and nuisances of the verdict, the first the best
  std::vector<std::string>
      ranked;               // all effects, by evidence (that of the refit where there is one)
  double error_before = 0;  // held out, in multiples of the case's noise
  double error_best = 0;    // with the first one named; 0: none was
  double evidence = 0, second_evidence = 0, control = 0, left = 0;
  // Of the first hidden effect, fitted; false where it is not in the library, has no size, or its
  // fit failed.
  bool has_truth = false;
  double error_after = 0;  // held out, in multiples of the noise
  // |estimate − truth| / |truth|, each component in units of its detectable size: weight along a
  // bar, say, hardly shows, and need not be known.
  double relative_error = 0;
  std::vector<char> covered;  // per amplitude: the 95 % interval holds the truth
  double seconds = 0;
};

// Fits and diagnoses <folder>/<case> as its experiment says, and writes diagnosis.json there. The
// truth is opened only afterwards.
TrialOutcome RunCase(const std::filesystem::path& folder);

// outcome.json
void SaveOutcome(const TrialOutcome& outcome, const std::filesystem::path& file);
TrialOutcome LoadOutcome(const std::filesystem::path& file);

// All cases of a folder that have no outcome yet, `workers` at a time, each in a process of its
// own; a case is claimed by locking a file in it, so that several calls may share the folder.
int RunTrials(const std::filesystem::path& folder, int workers);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_RUN_H_
