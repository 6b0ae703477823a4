// Diagnoses sealed cases and keeps the outcome of each in its folder.
#ifndef LACUNA_TRIALS_TRIAL_RUN_H_
#define LACUNA_TRIALS_TRIAL_RUN_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis_result.h"
#include "record/decision_record.h"
#include "record/verdict.h"
#include "trials/trial_case.h"

namespace lacuna {

// The diagnosis of a case, and the fit of its hidden effect compared with the truth. Held-out
// errors are root mean squares in multiples of the noise of the case.
struct TrialOutcome {
  Verdict verdict = Verdict::kNoPower;
  std::vector<std::string> named;   // effects and nuisances of the verdict, the best one first
  std::vector<std::string> ranked;  // all effects, as RankedTypes() orders them
  double error_before = 0;          // held-out, of the model without any of them
  // The posterior of all hypotheses, the most probable one first; empty for outcomes of older
  // versions.
  std::vector<HypothesisProbability> probabilities;
  // How often the rules of the decision give each answer, to first order, in recordings that are
  // simulated with the hidden effect. Only of cases with one hidden effect.
  std::optional<RecordedPower> simulated;
  // Whether the first hidden effect was fitted, so that the following values hold. False if it is
  // not in the library, has no size, or could not be fitted.
  bool has_truth = false;
  double error_after = 0;  // held-out error with the hidden effect fitted
  // |estimate − truth| / |truth|, with each component divided by its detectable size, so that a
  // component with little influence (such as weight along a bar) has little weight.
  double relative_error = 0;
  std::vector<char> covered;  // for each amplitude: whether the 95 % interval contains the truth
  double seconds = 0;         // wall time of fit and diagnosis
};

// The types of the effects of a diagnosis: those with a usable refit by its evidence, then the
// others by their first-order evidence.
std::vector<std::string> RankedTypes(const std::vector<RankedEffect>& effects);

// Fits and diagnoses the case in `folder` according to experiment.yaml in `output`, and keeps there
// diagnosis.json and what it was decided from. `output` is `folder` unless a further recording is
// diagnosed (trials/follow_up.h). The truth is opened only afterwards. Throws InputError if the
// case cannot be read or fitted.
TrialOutcome RunCase(const std::filesystem::path& folder, const std::filesystem::path& output);

// Write and read outcome.json in a folder. Both throw InputError if the file cannot be used.
void WriteTrialOutcome(const TrialOutcome& outcome, const std::filesystem::path& folder);
TrialOutcome ReadTrialOutcome(const std::filesystem::path& folder);

// Decides again upon what RunCase() has kept in `output`, with the rules as they are now, and
// replaces what outcome.json there has from the decision. False where nothing was kept. Throws
// InputError if a file cannot be read.
bool RedecideOutcome(const TrialCase& trial, const std::filesystem::path& output);

// Diagnoses all cases of a folder that have no outcome yet: see WorkOn (trials/case_files.h).
bool RunTrials(const std::filesystem::path& folder, int workers);

}  // namespace lacuna

#endif  // LACUNA_TRIALS_TRIAL_RUN_H_
