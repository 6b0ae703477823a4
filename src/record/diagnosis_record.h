// The result of a diagnosis as plain data: diagnosis/diagnosis.json in the run's folder.
//
// It holds everything that the report needs, so that a diagnosis can be explained without its model
// and its recordings. Evidence is the log Bayes factor against the unchanged model, less ln n for
// the n effects (or nuisances) that were tried, each of which has an equal share of the prior. The
// nuisances of every model are not selected, so that nothing is subtracted from theirs. σ is the
// standard deviation of the noise.
#ifndef LACUNA_RECORD_DIAGNOSIS_RECORD_H_
#define LACUNA_RECORD_DIAGNOSIS_RECORD_H_

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "record/agreement_record.h"
#include "record/by_data_kind.h"
#include "record/decision_record.h"
#include "record/model_errors.h"
#include "record/verdict.h"

namespace lacuna {

// An estimate with its 95 % interval, SI. A side that the data do not bound is infinite.
struct RecordedInterval {
  double value = 0, low = 0, high = 0;
};

// One of the parameters that define the size of an effect, in its unit (SI).
struct RecordedSize {
  std::string parameter, unit;
  // The first-order estimate and its standard deviation, which is infinite where the data do not
  // determine it.
  double expected = 0, deviation = 0;
  double detectable = 0;  // the smallest detectable size
  // After a usable refit; absent for a pilot hypothesis.
  std::optional<RecordedInterval> refitted = {};
  // The largest distance from the value at which the effect vanishes that is plausible in the
  // model; NaN for a pilot hypothesis.
  double plausible = std::numeric_limits<double>::quiet_NaN();
  // The refit has ended at the limit of what is plausible, which cuts its interval off.
  bool at_limit = false;
};

// Another parameter of a refitted effect, such as a place or a time, in its unit (SI).
struct RecordedValue {
  std::string parameter, unit;
  RecordedInterval found;
};

// The first-order prediction for an effect.
struct RecordedScore {
  double evidence = 0;   // of the best variant, less ln of the number of variants, too
  double explained = 0;  // share of the squared misfit
  // Share of the effect's influence that the fitted parameters can compensate for; 1: undetectable.
  double absorbed = 1;
  double held_out_rms_over_sigma = 0;  // expected error of the held-out frames
};

// The model fitted again with an effect.
struct RecordedRefit {
  std::string message;      // the reason why it is not usable; empty where it is
  std::string unconverged;  // the reason why the fit ended too early; empty where it has converged
  double evidence = 0;      // less ln of the number of variants that it cannot reach, too
  double held_out_evidence = 0;  // contribution of the held-out frames
  double explained = 0;          // share of the squared misfit
  double rms_over_sigma = 0;     // all frames, with the adopted nuisances at their best
  ModelErrors errors;
  std::vector<RecordedValue> others;  // empty if the refit is not usable
  // The held-out frames would refute the effect, had its size not ended at the limit of what is
  // plausible.
  bool fails_at_limit = false;
  // σ², the squared misfit of each kind of data that the effect removes; negative where it adds to
  // it. Absent where the fitted recordings have one kind only, and if the refit is not usable.
  std::optional<ByDataKind> removed = {};
};

// An effect in its best variant.
struct RecordedEffect {
  std::string type, title;  // "drag", "Drag of the surrounding fluid"
  std::string variant;      // "at the tip"; empty where there is only one
  std::string separating_experiment;
  std::vector<std::string> look_alikes;  // types indistinguishable to first order
  RecordedScore first_order;
  std::vector<RecordedSize> sizes;
  std::optional<RecordedRefit> refit;  // absent where it was not refitted

  bool HasUsableRefit() const { return refit && refit->message.empty(); }
};

struct RecordedNuisance {
  std::string name, what;               // "grip_compliance"; a phrase with its place or time
  std::string advice = {};              // how to check for it, or to remove it
  double evidence = 0;                  // first-order evidence
  double explained = 0;                 // share of the squared misfit
  std::optional<double> refitted = {};  // evidence after a refit with it
  bool adopted = false;                 // certain enough to be part of all models
  // Evidence for an effect that the uncertainty in this nuisance's influence could account for.
  double evidence_uncertainty = 0;
};

// The noise that is assumed in the computation of evidence.
struct RecordedNoise {
  double coordinate = 0, scanned_point = 0;  // m, σ; 0 where there are none
  double correlation_time = 0;               // s; 0: white in time
  double variance_factor = 1;                // variance divided by that of the given σ
};

// Effects refitted in place of the adopted nuisances, against a model without both.
struct RecordedAlternatives {
  std::vector<RecordedEffect> effects;
  double nuisances_evidence = 0;
  double rms_over_sigma_without_both = 0;  // held-out frames, model without both
};

struct DiagnosisRecord : Conclusion {
  RecordedNoise noise;
  double time_step = 0;       // s, of the simulations
  DecisionRecord decision;    // what the verdict follows from
  AgreementRecord agreement;  // of the recordings about the parameters of the fitted model
  // Over all frames, with the adopted nuisances at their best: of the model as it is, and of the
  // best-fitting model, i.e. the one with the smallest residual of it and of all refits with
  // one effect or two that are not refuted.
  double baseline_rms_over_sigma = 0, best_rms_over_sigma = 0;
  ModelErrors errors;  // errors of the unchanged model
  std::vector<RecordedNuisance> nuisances;
  std::vector<RecordedEffect> ranking;  // sorted by first-order evidence
  std::vector<UntriedEffect> untried;
  RecordedAlternatives alternatives;
};

// The effect that explains a part of the misfit under the verdict "not in library": the one with
// which the hypotheses that contain it reach kStatedProbability together, and that explains more
// than half of the squared misfit in excess of the noise. The model comes closer to the
// measurements with it, although something is missing that the catalogue does not have, and for
// which it may stand in. Empty for other verdicts, and where there is no such effect.
std::optional<std::string> PartlyExplainedBy(const DiagnosisRecord& diagnosis);

// Whether the diagnosis in this folder, <run>/diagnosis, belongs to the fit whose calibration.json
// has this hash and was not changed since: of_fit.json beside diagnosis.json says both. False where
// one of them is absent. Throws InputError when of_fit.json cannot be read.
bool IsDiagnosisOf(const std::string& fit, const std::filesystem::path& folder);

void WriteDiagnosisFile(const DiagnosisRecord& record, const std::filesystem::path& file);

// Throws InputError when the file is not a diagnosis, or one in another format.
DiagnosisRecord ReadDiagnosisFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_DIAGNOSIS_RECORD_H_
