// The verdict of a diagnosis and the reasons for it, as plain data.
//
// A reason holds the data for its sentence, which report/verdict_text.h writes.
// Evidence is that of record/diagnosis_record.h. Errors with "over_sigma" in their name are rms
// residuals divided by the standard deviation of the noise; 1 is noise alone. A `nuisance` is an
// index in the list of nuisances of the same diagnosis.
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

// A nuisance explains this share of the squared misfit.
struct NuisanceExplains {
  int nuisance = 0;
  double share = 0;
};

// The best effect explains this share of the squared misfit in excess of the noise. What remains
// over all frames, with everything beside it that the test of adequacy has taken
// (RecordedAdequacy::beside), is more than noise leaves.
struct ResidualRemains {
  std::string effect;
  double share = 0;
  double rms_over_sigma = 0;
};

// Beside the best effect there is evidence for another one.
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

using VerdictReason =
    std::variant<NothingDetectable, ErrorIsNoise, ErrorUnexplained, NuisanceExplains,
                 ResidualRemains, EvidenceForAnother, EffectReducesError>;

// --- Steps that would resolve an open question ---

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

using SuggestedStep = std::variant<AddAndDiagnose, SeparateLookAlikes, CheckNuisance>;

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
