// What a diagnosis said: diagnosis.json, and as plain data what is read back from it.
#ifndef LACUNA_DIAGNOSIS_DIAGNOSIS_RECORD_H_
#define LACUNA_DIAGNOSIS_DIAGNOSIS_RECORD_H_

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/diagnosis_result.h"

namespace lacuna {

struct RecordedInterval {
  double value = 0, low = 0, high = 0;  // 95 %
};

// One of an effect's amounts, in its unit (SI). Infinite: the data does not tell it.
struct RecordedSize {
  std::string parameter, unit;
  double expected = 0, deviation = 0;
  double detectable = 0;                     // the smallest that these recordings could have shown
  std::optional<RecordedInterval> refitted;  // after a usable refit; not of a pilot
};

// A parameter of a refitted effect that does not make its size: its place, its time. SI.
struct RecordedValue {
  std::string parameter, unit;
  RecordedInterval found;
};

// An effect in the best of its variants (Score, RankedEffect).
struct RecordedEffect {
  std::string type, variant;
  double evidence = 0;           // ln of the odds against the model as it is, to first order
  double explained = 0;          // share of the squared misfit
  double absorbed = 1;           // share that the fitted parameters can do as well
  double expected_in_noise = 0;  // of held-out frames, σ
  std::vector<RecordedSize> sizes;
  std::vector<std::string> look_alikes;
  // After the refit, where there was one.
  bool refitted = false;
  std::string refit_message;  // why it is not usable; empty: it is
  double refit_evidence = 0;
  ModelErrors errors;
  std::vector<RecordedValue> others;  // of a usable refit

  bool HasUsableRefit() const { return refitted && refit_message.empty(); }
};

struct RecordedNuisance {
  std::string name, what;
  double evidence = 0, explained = 0;
  std::optional<double> refitted;  // evidence once the model with it has been fitted again
  bool adopted = false;            // taken into the model
};

struct DiagnosisRecord {
  std::string verdict;               // "missing", "adequate", …
  std::vector<std::string> effects;  // that it names, the best first
  std::string explanation, experiment;
  double noise = 0, scan_noise = 0;  // m, of a coordinate, of a scanned point
  double correlation_time = 0;       // s, of the noise
  double variance_factor = 1;        // of the noise against what was given
  double time_step = 0;              // s, that it was made with
  double control = 0;        // the evidence that one in twenty controls finds without an effect
  double left_in_noise = 0;  // σ, of the best hypothesis
  ModelErrors errors;        // of the model as it is
  std::vector<RecordedNuisance> nuisances;
  std::vector<RecordedEffect> ranking;
  std::vector<UntriedEffect> untried;  // with the reason
  // Refitted in place of the nuisances that were adopted beyond those that every model has, whose
  // evidence this is (Diagnosis::Instead).
  std::vector<RecordedEffect> instead;
  double nuisances_evidence = 0;
};

// "missing {drag}"
std::string VerdictWithNames(const DiagnosisRecord& diagnosis);

void SaveDiagnosis(const Diagnosis& diagnosis, const std::filesystem::path& file);

// Throws InputError when it is not one.
DiagnosisRecord ReadDiagnosisFile(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DIAGNOSIS_RECORD_H_
