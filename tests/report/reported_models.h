// What the tests of a headline and of its verdict share: models as a report shows them, in memory.
#ifndef LACUNA_TESTS_REPORT_REPORTED_MODELS_H_
#define LACUNA_TESTS_REPORT_REPORTED_MODELS_H_

#include <string>
#include <vector>

#include "report/reported_run.h"

namespace lacuna {

// A usable fit of one recording with this error of its held-out frames, m and multiples of the
// noise.
inline ReportedModel ModelWithError(double rms, double over_sigma) {
  ReportedModel model;
  model.name = "bar";
  model.calibration.usable = true;
  model.calibration.recordings.resize(1);
  model.calibration.recordings[0].name = "swing";
  model.errors.held_out_rms = rms;
  model.errors.rms_over_sigma = over_sigma;
  model.errors.has_held_out = true;
  return model;
}

// A diagnosis with this verdict on these effects or nuisances. It has ranked the effects
// viscoelastic_branch and drag, and has the nuisance clock.
inline DiagnosisRecord DiagnosisNaming(Verdict verdict, const std::vector<std::string>& names) {
  DiagnosisRecord diagnosis;
  diagnosis.verdict = verdict;
  diagnosis.effects = names;
  diagnosis.ranking.resize(2);
  diagnosis.ranking[0].type = "viscoelastic_branch";
  diagnosis.ranking[0].title = "Viscoelastic branch (Maxwell element of a Prony series)";
  diagnosis.ranking[1].type = "drag";
  diagnosis.ranking[1].title = "Drag of the surrounding medium";
  diagnosis.ranking[1].separating_experiment = "Film it in a vacuum.";
  diagnosis.nuisances.resize(1);
  diagnosis.nuisances[0].name = "clock";
  diagnosis.nuisances[0].what = "the clock of swing";
  diagnosis.nuisances[0].advice = "give clock_deviation";
  return diagnosis;
}

// Adds the posterior probability of a hypothesis.
inline void AddProbability(
    DiagnosisRecord* diagnosis, const std::vector<std::string>& names, double probability,
    HypothesisProbability::Kind kind = HypothesisProbability::Kind::kEffect) {
  HypothesisProbability one;
  one.kind = kind;
  one.names = names;
  one.probability = probability;
  diagnosis->decision.probabilities.push_back(one);
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_REPORT_REPORTED_MODELS_H_
