#include "support/small_ledger.h"

#include <cmath>

namespace lacuna {
namespace {

FittedParameter Parameter(const std::string& name, double value, double deviation, bool log_scale) {
  FittedParameter parameter;
  parameter.name = name;
  parameter.unit = "Pa";
  parameter.log_scale = log_scale;
  parameter.estimate.value = value;
  parameter.estimate.posterior_deviation = deviation;
  return parameter;
}

// One fitted recording and one that is not.
CalibrationRecord Record(double in_fit, double held_out, double other) {
  constexpr double kNoise = 1e-4;  // m
  CalibrationRecord record;
  record.usable = true;
  record.noise = kNoise;
  const auto measure = [](double rms, int points) {
    return MisfitMeasure{points, points, rms, 2 * rms, rms / kNoise};
  };
  record.recordings = {{"a", true, kNoise, measure(in_fit, 30), measure(held_out, 10), {}},
                       {"b", false, kNoise, {}, measure(other, 30), {}}};
  return record;
}

RecordedEffect Tried(const std::string& type, double held_out_rms) {
  RecordedEffect effect;
  effect.type = effect.title = type;
  RecordedRefit& refit = effect.refit.emplace();
  refit.errors.in_fit_rms = refit.errors.held_out_rms = held_out_rms;
  refit.errors.rms_over_sigma = refit.errors.without_nuisances = 1e4 * held_out_rms;
  refit.errors.has_held_out = true;
  return effect;
}

}  // namespace

Ledger SmallLedger() {
  Ledger ledger;
  CalibrationRecord before = Record(2e-4, 4e-4, 4e-4), after = Record(1e-4, 2e-4, 2e-4);
  before.parameters = {Parameter("young_modulus", 1e5, 0.1, true)};
  after.parameters = {Parameter("young_modulus", 1e5 * std::exp(0.3), 0.1, true),
                      Parameter("drag.coefficient", 3, 1, false)};
  ledger.models.push_back(MakeLedgerModel(ledger, "/runs/bar/", before, -1, ""));
  DiagnosisRecord diagnosis;
  diagnosis.verdict = Verdict::kMissing;
  diagnosis.effects = {"drag"};
  diagnosis.ranking = {Tried("drag", 2e-4), Tried("mass_damping", 3e-4)};
  ledger.models.back().diagnosis = diagnosis;
  ledger.models.push_back(MakeLedgerModel(ledger, "/runs/bar+drag", after, 0, "drag"));
  ledger.ending = {LedgerEnding::Reason::kLittleGain, 0.6};
  return ledger;
}

}  // namespace lacuna
