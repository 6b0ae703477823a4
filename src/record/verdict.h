// The verdict of a diagnosis and the reasons for it, as plain data.
//
// A reason holds the data for its sentence, which report/verdict_text.h writes.
// Evidence is the natural logarithm of the odds against the model without the effect. Errors with
// "over_sigma" in their name are rms residuals divided by the standard deviation of the noise; 1 is
// noise alone. A `nuisance` is an index in the list of nuisances of the same diagnosis.
#ifndef LACUNA_RECORD_VERDICT_H_
#define LACUNA_RECORD_VERDICT_H_

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <variant>
#include <vector>

namespace lacuna {

enum class Verdict {
  kAdequate,      // the residual is noise, nothing is missing
  kMissing,       // one effect is missing, and it is named
  kAmbiguous,     // several causes explain the residual, and the recordings cannot separate them
  kNuisance,      // errors of the measurement or the discretisation explain the residual
  kNotInLibrary,  // something is missing that no effect of the catalogue explains
  kNoPower,       // the recordings could not show any effect of plausible size
};

// The verdict's name in files and reports, e.g. "not in library".
std::string VerdictName(Verdict verdict);
// The verdict of this name. Throws InputError if there is none.
Verdict VerdictFromName(const std::string& name);

// --- Reasons for "no power", "adequate", "nuisance" and "not in library" ---

// No effect, at the largest plausible size, would be visible beyond the noise and beyond what the
// fitted parameters can compensate for.
struct NothingDetectable {};

// The error is that of the noise, and no effect has enough evidence.
struct ErrorIsNoise {
  double rms = 0;  // m
  double rms_over_sigma = 0;
};

// The error exceeds the noise, and no effect has enough evidence.
struct ErrorUnexplained {
  double rms = 0;  // m
  double rms_over_sigma = 0;
  double best_evidence = 0;
};

// The uncertainty in the discretisation error could account for `uncertainty` of the best effect's
// evidence.
struct UncertainDiscretisation {
  int nuisance = 0;
  double best_evidence = 0, uncertainty = 0;
};

// A nuisance explains this share of the squared misfit.
struct NuisanceExplains {
  int nuisance = 0;
  double share = 0;
};

// A nuisance is certainly present, and explains less than this share of a misfit that is noise.
struct NuisanceIsNegligible {
  int nuisance = 0;
  double share = 0;
};

// The best effect explains this share of the squared misfit in excess of the noise, but what
// remains over all frames exceeds the noise.
struct ResidualRemains {
  std::string effect;
  double share = 0;
  double rms_over_sigma = 0;
};

// With the best effect, the error of the held-out frames still exceeds the noise.
struct HeldOutErrorRemains {
  std::string effect;
  double evidence = 0;
  double over_sigma_before = 0, over_sigma_after = 0;
};

// With the best effect in the model, there is evidence for another one.
struct EvidenceForAnother {
  std::string effect;
  double evidence = 0;
  std::string other;
  double other_evidence = 0;
};

// --- Reasons for "missing" and "ambiguous" ---

// With the best effect, the error falls.
struct EffectReducesError {
  std::string effect;
  double evidence = 0;
  bool held_out = true;                 // if nothing was held out, the fitted frames are judged
  bool adjusted_for_nuisances = false;  // the errors exclude what the adopted nuisances explain
  double over_sigma_before = 0, over_sigma_after = 0;
};

// A rival with less evidence than the best effect predicts the recordings that were not fitted
// better.
struct RivalPredictsBetter {
  std::string effect;
  double evidence = 0;
  double over_sigma = 0, over_sigma_of_best = 0;
};

// A rival has comparable first-order evidence, but its refit failed.
struct RivalNotFitted {
  std::string effect;
  double first_order_evidence = 0;
};

// A nuisance has more evidence than the best effect.
struct NuisanceHasMoreEvidence {
  int nuisance = 0;
  double evidence = 0;
};

// If the contributions of the adopted nuisances are included, the held-out error rises.
struct UnadjustedErrorRises {
  double rms_before = 0, rms_after = 0;  // m
};

// Without the adopted nuisances, an effect explains the recordings nearly as well as they do.
struct EffectReplacesNuisances {
  std::string effect;
  double evidence = 0, nuisances_evidence = 0;
  std::vector<std::string> nuisances;  // names
  bool held_out = true;                // as in EffectReducesError
  double over_sigma_before = 0, over_sigma_after = 0;
};

using VerdictReason =
    std::variant<NothingDetectable, ErrorIsNoise, ErrorUnexplained, UncertainDiscretisation,
                 NuisanceExplains, NuisanceIsNegligible, ResidualRemains, HeldOutErrorRemains,
                 EvidenceForAnother, EffectReducesError, RivalPredictsBetter, RivalNotFitted,
                 NuisanceHasMoreEvidence, UnadjustedErrorRises, EffectReplacesNuisances>;

// --- Steps that would resolve an open question ---

// Follow the nuisance's advice (e.g. a finer mesh), then fit or diagnose again.
struct RefineDiscretisation {
  int nuisance = 0;
  bool fit_again = false;  // false: diagnosing again is enough
};

// Add the effect and diagnose again: `expected_next` should then be named.
struct AddAndDiagnose {
  std::string effect, expected_next;
};

// Make the experiment that separates the effect from its look-alikes.
struct SeparateLookAlikes {
  std::string effect;
};

// Follow the nuisance's advice to find out whether it is the cause.
struct CheckNuisance {
  int nuisance = 0;
};

using SuggestedStep =
    std::variant<RefineDiscretisation, AddAndDiagnose, SeparateLookAlikes, CheckNuisance>;

// The conclusion of a diagnosis.
struct Conclusion {
  Verdict verdict = Verdict::kNoPower;
  std::vector<std::string> effects;  // names of effects and nuisances, the best first
  std::vector<VerdictReason> reasons;
  std::vector<SuggestedStep> next_steps;  // empty where nothing is open
};

// The keys "verdict", "effects", "reasons" and "next_steps".
nlohmann::json ConclusionToJson(const Conclusion& conclusion);
// Throws nlohmann::json::exception and InputError.
Conclusion ConclusionFromJson(const nlohmann::json& value);

}  // namespace lacuna

#endif  // LACUNA_RECORD_VERDICT_H_
