#include "diagnosis/diagnosis_record.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"

namespace lacuna {
namespace {

using nlohmann::json;

// JSON has no infinity, of either sign: null.
double FromNumber(const json& value, double sign = 1) {
  return value.is_null() ? sign * std::numeric_limits<double>::infinity() : value.get<double>();
}

std::optional<double> OptionalFrom(const json& entry, const std::string& field) {
  const json& value = entry.at(field);
  return value.is_null() ? std::nullopt : std::optional<double>(value.get<double>());
}

// Of a model; has_held_out is the recordings', and stands once.
json ErrorsJson(const ModelErrors& errors) {
  return {{"in_fit_rms_m", errors.in_fit_rms},
          {"held_out_rms_m", errors.held_out_rms},
          {"held_out_in_noise", errors.in_noise},
          {"held_out_in_noise_without_nuisances", errors.without_nuisances},
          {"unfitted_in_noise", errors.unfitted_in_noise}};
}
ModelErrors ErrorsFrom(const json& value, bool has_held_out) {
  ModelErrors errors;
  errors.in_fit_rms = value.at("in_fit_rms_m");
  errors.held_out_rms = value.at("held_out_rms_m");
  errors.in_noise = value.at("held_out_in_noise");
  errors.without_nuisances = value.at("held_out_in_noise_without_nuisances");
  errors.unfitted_in_noise = value.at("unfitted_in_noise");
  errors.has_held_out = has_held_out;
  return errors;
}

RecordedInterval IntervalFrom(const json& value) {
  return {value.at("value"), FromNumber(value.at("low_95"), -1), FromNumber(value.at("high_95"))};
}

RecordedEffect EffectFrom(const json& entry, bool has_held_out) {
  RecordedEffect effect;
  effect.type = entry.at("effect");
  effect.variant = entry.at("variant");
  effect.evidence = entry.at("evidence");
  effect.explained = entry.at("explained_share");
  effect.absorbed = entry.at("absorbed_share");
  effect.expected_in_noise = entry.at("expected_held_out_in_noise");
  for (const json& size : entry.at("sizes")) {
    effect.sizes.push_back({size.at("parameter"),
                            size.at("unit"),
                            size.at("expected"),
                            FromNumber(size.at("deviation")),
                            FromNumber(size.at("detectable")),
                            {}});
    if (const json& found = size.at("refitted"); !found.is_null())
      effect.sizes.back().refitted = IntervalFrom(found);
  }
  effect.look_alikes = entry.at("look_alikes").get<std::vector<std::string>>();
  effect.refitted = entry.at("refitted");
  effect.errors.has_held_out = has_held_out;
  if (effect.refitted) {
    const json& refit = entry.at("refit");
    effect.refit_message = refit.at("message");
    effect.refit_evidence = refit.at("evidence");
    for (const json& other : refit.at("others"))
      effect.others.push_back({other.at("parameter"), other.at("unit"), IntervalFrom(other)});
    effect.errors = ErrorsFrom(refit, has_held_out);
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
  record.scan_noise = value.at("scan_noise_m");
  record.correlation_time = value.at("noise_correlation_time_s");
  record.variance_factor = value.at("noise_variance_factor");
  record.control = value.at("control_evidence");
  record.time_step = value.at("time_step_s");
  record.left_in_noise = value.at("left_in_noise");
  const json& instead = value.at("instead");
  record.nuisances_evidence = instead.at("nuisances_evidence");
  for (const json& entry : instead.at("effects"))
    record.instead.push_back(EffectFrom(entry, value.at("has_held_out")));
  record.errors = ErrorsFrom(value, value.at("has_held_out"));
  for (const json& entry : value.at("nuisances"))
    record.nuisances.push_back({entry.at("nuisance"), entry.at("what"), entry.at("evidence"),
                                entry.at("explained_share"),
                                OptionalFrom(entry, "refitted_evidence"), entry.at("adopted")});
  for (const json& entry : value.at("ranking"))
    record.ranking.push_back(EffectFrom(entry, record.errors.has_held_out));
  for (const json& entry : value.at("untried"))
    record.untried.push_back({entry.at("effect"), entry.at("why")});
  return record;
}

}  // namespace

namespace {

json Number(double value) { return std::isfinite(value) ? json(value) : json(nullptr); }

json IntervalJson(const ParameterEstimate& found) {
  return {{"value", found.value}, {"low_95", Number(found.low)}, {"high_95", Number(found.high)}};
}

json EffectJson(const RankedEffect& effect) {
  json sizes = json::array();
  for (size_t k = 0; k < effect.scored.parameters.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    sizes.push_back({{"parameter", effect.scored.parameters[k]},
                     {"unit", effect.scored.units[k]},
                     {"expected", effect.scored.score.size[at]},
                     {"deviation", Number(effect.scored.score.deviation[at])},
                     {"detectable", Number(effect.scored.score.detectable[at])},
                     {"refitted", nullptr}});
    if (k < effect.sizes.size()) sizes.back()["refitted"] = IntervalJson(effect.sizes[k]);
  }
  json entry = {{"effect", effect.scored.candidate.type},
                {"variant", effect.scored.candidate.variant},
                {"evidence", effect.scored.score.evidence},
                {"explained_share", effect.scored.score.explained},
                {"absorbed_share", effect.scored.score.absorbed},
                {"expected_held_out_in_noise", effect.scored.score.held_out_rms_over_sigma},
                {"sizes", sizes},
                {"look_alikes", effect.scored.look_alikes},
                {"refitted", effect.refitted}};
  if (effect.refitted) {
    json others = json::array();
    for (const NamedEstimate& other : effect.others) {
      others.push_back({{"parameter", other.name}, {"unit", other.unit}});
      others.back().update(IntervalJson(other.estimate));
    }
    entry["refit"] = {{"message", effect.refit_message},
                      {"evidence", effect.evidence},
                      {"held_out_evidence", effect.held_out_evidence},
                      {"explained_share", effect.explained},
                      {"left_in_noise", effect.left_in_noise},
                      {"others", others},
                      {"further",
                       {{"effect", effect.further.type},
                        {"evidence", effect.further.evidence},
                        {"of_nuisance", effect.further.of_nuisance}}}};
    entry["refit"].update(ErrorsJson(effect.errors));
  }
  return entry;
}

}  // namespace

void SaveDiagnosis(const Diagnosis& diagnosis, const std::filesystem::path& file) {
  json ranking = json::array(), instead = json::array();
  for (const RankedEffect& effect : diagnosis.ranking) ranking.push_back(EffectJson(effect));
  for (const RankedEffect& effect : diagnosis.instead.effects)
    instead.push_back(EffectJson(effect));
  json nuisances = json::array();
  for (const ScoredNuisance& nuisance : diagnosis.nuisances)
    nuisances.push_back(
        {{"nuisance", nuisance.candidate.card.name},
         {"what", nuisance.candidate.what},
         {"evidence", nuisance.evidence},
         {"refitted_evidence", nuisance.refitted ? json(*nuisance.refitted) : json(nullptr)},
         {"explained_share", nuisance.explained},
         {"adopted", nuisance.adopted},
         {"doubt", nuisance.doubt}});
  json untried = json::array();
  for (const UntriedEffect& effect : diagnosis.untried)
    untried.push_back({{"effect", effect.type}, {"why", effect.why}});
  json all = {{"schema_version", 8},
              {"verdict", VerdictName(diagnosis.verdict)},
              {"effects", diagnosis.effects},
              {"explanation", diagnosis.explanation},
              {"experiment", diagnosis.experiment},
              {"noise_m", diagnosis.noise},
              {"scan_noise_m", diagnosis.scan_noise},
              {"time_step_s", diagnosis.time_step},
              {"noise_correlation_time_s", diagnosis.noise_level.correlation_time},
              {"noise_variance_factor", diagnosis.noise_level.variance},
              {"has_held_out", diagnosis.errors.has_held_out},
              {"control_evidence", diagnosis.control},
              {"left_in_noise", diagnosis.left_in_noise},
              {"present_in_noise", diagnosis.present_in_noise},
              {"nuisances", nuisances},
              {"ranking", ranking},
              {"instead",
               {{"nuisances_evidence", diagnosis.instead.nuisances_evidence},
                {"held_out_in_noise_without_nuisances", diagnosis.instead.bare.without_nuisances},
                {"effects", instead}}},
              {"untried", untried}};
  all.update(ErrorsJson(diagnosis.errors));
  WriteFileAtomically(file, all.dump(2) + "\n");
}

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
