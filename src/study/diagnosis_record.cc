#include "study/diagnosis_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/error.h"

namespace lacuna {
namespace {

using nlohmann::json;

// JSON has no infinity: null.
double FromNumber(const json& value) {
  return value.is_null() ? std::numeric_limits<double>::infinity() : value.get<double>();
}

RecordedEffect EffectFrom(const json& entry) {
  RecordedEffect effect;
  effect.type = entry.at("effect");
  effect.variant = entry.at("variant");
  effect.evidence = entry.at("evidence");
  effect.explained = entry.at("explained_share");
  effect.absorbed = entry.at("absorbed_share");
  effect.expected_in_noise = entry.at("expected_held_out_in_noise");
  for (const json& size : entry.at("sizes"))
    effect.sizes.push_back({size.at("parameter"), size.at("unit"), size.at("expected"),
                            FromNumber(size.at("deviation")), FromNumber(size.at("detectable"))});
  effect.look_alikes = entry.at("look_alikes").get<std::vector<std::string>>();
  effect.refitted = entry.at("refitted");
  if (effect.refitted) {
    const json& refit = entry.at("refit");
    effect.refit_message = refit.at("message");
    effect.refit_evidence = refit.at("evidence");
    effect.errors.in_fit_rms = refit.at("in_fit_rms_m");
    effect.errors.held_out_rms = refit.at("held_out_rms_m");
    effect.errors.in_noise = refit.at("held_out_in_noise");
    effect.errors.without_nuisances = refit.at("held_out_in_noise_without_nuisances");
  }
  return effect;
}

DiagnosisRecord FromJson(const json& value) {
  DiagnosisRecord record;
  record.verdict = value.at("verdict");
  record.effects = value.at("effects").get<std::vector<std::string>>();
  record.explanation = value.at("explanation");
  record.experiment = value.at("experiment");
  record.noise = value.at("noise_m");
  record.correlation_time = value.at("noise_correlation_time_s");
  record.variance_factor = value.at("noise_variance_factor");
  record.control = value.at("control_evidence");
  record.left_in_noise = value.at("left_in_noise");
  record.errors = {value.at("in_fit_rms_m"), value.at("held_out_rms_m"),
                   value.at("held_out_in_noise"), value.at("held_out_in_noise_without_nuisances"),
                   value.at("has_held_out")};
  for (const json& entry : value.at("nuisances"))
    record.nuisances.push_back({entry.at("nuisance"), entry.at("what"), entry.at("evidence"),
                                entry.at("explained_share"), entry.at("adopted")});
  for (const json& entry : value.at("ranking")) {
    record.ranking.push_back(EffectFrom(entry));
    record.ranking.back().errors.has_held_out = record.errors.has_held_out;
  }
  for (const json& entry : value.at("untried"))
    record.untried.push_back({entry.at("effect"), entry.at("why")});
  return record;
}

}  // namespace

std::string VerdictWithNames(const DiagnosisRecord& diagnosis) {
  if (diagnosis.effects.empty()) return diagnosis.verdict;
  return fmt::format("{} {{{}}}", diagnosis.verdict, fmt::join(diagnosis.effects, ", "));
}

DiagnosisRecord ReadDiagnosisFile(const std::filesystem::path& file) {
  std::ifstream stream(file);
  try {
    return FromJson(json::parse(stream));
  } catch (const json::exception& problem) {
    throw InputError(file.string() + ": is no diagnosis: " + problem.what());
  }
}

}  // namespace lacuna
