#include "record/diagnosis_record.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/json_file.h"
#include "core/json_number.h"
#include "record/schema_version.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 10;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// has_held_out is the same for all models of a diagnosis and is written only once.
json ErrorsToJson(const ModelErrors& errors) {
  return {{"in_fit_rms_m", errors.in_fit_rms},
          {"held_out_rms_m", errors.held_out_rms},
          {"held_out_rms_over_sigma", errors.rms_over_sigma},
          {"held_out_rms_over_sigma_without_nuisances", errors.without_nuisances},
          {"unfitted_rms_over_sigma", errors.unfitted_rms_over_sigma}};
}

ModelErrors ErrorsFromJson(const json& value, bool has_held_out) {
  ModelErrors errors;
  errors.in_fit_rms = value.at("in_fit_rms_m");
  errors.held_out_rms = value.at("held_out_rms_m");
  errors.rms_over_sigma = value.at("held_out_rms_over_sigma");
  errors.without_nuisances = value.at("held_out_rms_over_sigma_without_nuisances");
  errors.unfitted_rms_over_sigma = value.at("unfitted_rms_over_sigma");
  errors.has_held_out = has_held_out;
  return errors;
}

json IntervalToJson(const RecordedInterval& interval) {
  return {{"value", interval.value},
          {"low_95", NumberOrNull(interval.low)},
          {"high_95", NumberOrNull(interval.high)}};
}

RecordedInterval IntervalFromJson(const json& value) {
  return {value.at("value"), NumberOr(value.at("low_95"), -kInfinity),
          NumberOr(value.at("high_95"), kInfinity)};
}

json SizeToJson(const RecordedSize& size) {
  return {{"parameter", size.parameter},
          {"unit", size.unit},
          {"expected", size.expected},
          {"deviation", NumberOrNull(size.deviation)},
          {"detectable", NumberOrNull(size.detectable)},
          {"plausible", NumberOrNull(size.plausible)},
          {"at_limit", size.at_limit},
          {"refitted", size.refitted ? IntervalToJson(*size.refitted) : json(nullptr)}};
}

RecordedSize SizeFromJson(const json& value) {
  RecordedSize size{value.at("parameter"),
                    value.at("unit"),
                    value.at("expected"),
                    NumberOr(value.at("deviation"), kInfinity),
                    NumberOr(value.at("detectable"), kInfinity),
                    {}};
  if (const json& found = value.at("refitted"); !found.is_null())
    size.refitted = IntervalFromJson(found);
  // Both are absent in diagnoses of earlier versions.
  if (value.contains("plausible")) size.plausible = NumberOr(value.at("plausible"), kNan);
  size.at_limit = value.value("at_limit", false);
  return size;
}

json RefitToJson(const RecordedRefit& refit) {
  json others = json::array();
  for (const RecordedValue& other : refit.others) {
    others.push_back({{"parameter", other.parameter}, {"unit", other.unit}});
    others.back().update(IntervalToJson(other.found));
  }
  json value = {{"message", refit.message},
                {"evidence", refit.evidence},
                {"held_out_evidence", refit.held_out_evidence},
                {"explained_share", refit.explained},
                {"rms_over_sigma", refit.rms_over_sigma},
                {"others", others}};
  if (!refit.unconverged.empty()) value["unconverged"] = refit.unconverged;
  if (refit.fails_at_limit) value["fails_at_limit"] = true;
  if (refit.removed) value["removed_misfit"] = ByDataKindToJson(*refit.removed);
  value.update(ErrorsToJson(refit.errors));
  return value;
}

RecordedRefit RefitFromJson(const json& value, bool has_held_out) {
  RecordedRefit refit;
  refit.message = value.at("message");
  refit.unconverged = value.value("unconverged", "");
  refit.fails_at_limit = value.value("fails_at_limit", false);
  refit.evidence = value.at("evidence");
  refit.held_out_evidence = value.at("held_out_evidence");
  refit.explained = value.at("explained_share");
  refit.rms_over_sigma = value.at("rms_over_sigma");
  refit.errors = ErrorsFromJson(value, has_held_out);
  for (const json& other : value.at("others"))
    refit.others.push_back({other.at("parameter"), other.at("unit"), IntervalFromJson(other)});
  // Absent with one kind of data, and in diagnoses of earlier versions.
  if (value.contains("removed_misfit"))
    refit.removed = ByDataKindFromJson(value.at("removed_misfit"));
  return refit;
}

json EffectsToJson(const std::vector<RecordedEffect>& effects) {
  json all = json::array();
  for (const RecordedEffect& effect : effects) {
    json sizes = json::array();
    for (const RecordedSize& size : effect.sizes) sizes.push_back(SizeToJson(size));
    all.push_back({{"effect", effect.type},
                   {"title", effect.title},
                   {"variant", effect.variant},
                   {"separating_experiment", effect.separating_experiment},
                   {"look_alikes", effect.look_alikes},
                   {"evidence", effect.first_order.evidence},
                   {"explained_share", effect.first_order.explained},
                   {"absorbed_share", effect.first_order.absorbed},
                   {"expected_held_out_rms_over_sigma", effect.first_order.held_out_rms_over_sigma},
                   {"sizes", sizes},
                   {"refit", effect.refit ? RefitToJson(*effect.refit) : json(nullptr)}});
  }
  return all;
}

std::vector<RecordedEffect> EffectsFromJson(const json& value, bool has_held_out) {
  std::vector<RecordedEffect> effects;
  for (const json& entry : value) {
    RecordedEffect& effect = effects.emplace_back();
    effect.type = entry.at("effect");
    effect.title = entry.at("title");
    effect.variant = entry.at("variant");
    effect.separating_experiment = entry.at("separating_experiment");
    effect.look_alikes = entry.at("look_alikes").get<std::vector<std::string>>();
    effect.first_order = {entry.at("evidence"), entry.at("explained_share"),
                          entry.at("absorbed_share"), entry.at("expected_held_out_rms_over_sigma")};
    for (const json& size : entry.at("sizes")) effect.sizes.push_back(SizeFromJson(size));
    if (const json& refit = entry.at("refit"); !refit.is_null())
      effect.refit = RefitFromJson(refit, has_held_out);
  }
  return effects;
}

json NuisancesToJson(const std::vector<RecordedNuisance>& nuisances) {
  json all = json::array();
  for (const RecordedNuisance& nuisance : nuisances)
    all.push_back({{"nuisance", nuisance.name},
                   {"what", nuisance.what},
                   {"advice", nuisance.advice},
                   {"evidence", nuisance.evidence},
                   {"refitted_evidence", nuisance.refitted ? json(*nuisance.refitted) : json()},
                   {"explained_share", nuisance.explained},
                   {"adopted", nuisance.adopted},
                   {"evidence_uncertainty", nuisance.evidence_uncertainty}});
  return all;
}

std::vector<RecordedNuisance> NuisancesFromJson(const json& value) {
  std::vector<RecordedNuisance> nuisances;
  for (const json& entry : value) {
    RecordedNuisance& nuisance = nuisances.emplace_back();
    nuisance.name = entry.at("nuisance");
    nuisance.what = entry.at("what");
    nuisance.advice = entry.at("advice");
    nuisance.evidence = entry.at("evidence");
    if (const json& refitted = entry.at("refitted_evidence"); !refitted.is_null())
      nuisance.refitted = refitted.get<double>();
    nuisance.explained = entry.at("explained_share");
    nuisance.adopted = entry.at("adopted");
    nuisance.evidence_uncertainty = entry.at("evidence_uncertainty");
  }
  return nuisances;
}

json ToJson(const DiagnosisRecord& record) {
  json untried = json::array();
  for (const UntriedEffect& effect : record.untried)
    untried.push_back({{"effect", effect.type}, {"why", effect.why}});
  json all = {{"schema_version", kSchemaVersion},
              {"noise_m", record.noise.coordinate},
              {"scan_noise_m", record.noise.scanned_point},
              {"noise_correlation_time_s", record.noise.correlation_time},
              {"noise_variance_factor", record.noise.variance_factor},
              {"time_step_s", record.time_step},
              {"decision", DecisionToJson(record.decision)},
              {"agreement", AgreementToJson(record.agreement)},
              {"baseline_rms_over_sigma", record.baseline_rms_over_sigma},
              {"best_rms_over_sigma", record.best_rms_over_sigma},
              {"has_held_out", record.errors.has_held_out},
              {"nuisances", NuisancesToJson(record.nuisances)},
              {"ranking", EffectsToJson(record.ranking)},
              {"untried", untried},
              {"alternatives",
               {{"effects", EffectsToJson(record.alternatives.effects)},
                {"nuisances_evidence", record.alternatives.nuisances_evidence},
                {"rms_over_sigma_without_both", record.alternatives.rms_over_sigma_without_both}}}};
  all.update(ErrorsToJson(record.errors));
  all.update(ConclusionToJson(record));
  return all;
}

DiagnosisRecord FromJson(const json& value) {
  RequireSchemaVersion(value, kSchemaVersion, "lacuna diagnose");
  DiagnosisRecord record;
  static_cast<Conclusion&>(record) = ConclusionFromJson(value);
  record.noise = {value.at("noise_m"), value.at("scan_noise_m"),
                  value.at("noise_correlation_time_s"), value.at("noise_variance_factor")};
  record.time_step = value.at("time_step_s");
  record.decision = DecisionFromJson(value.at("decision"));
  if (value.contains("agreement"))  // diagnoses of earlier versions have none
    record.agreement = AgreementFromJson(value.at("agreement"));
  record.baseline_rms_over_sigma = value.at("baseline_rms_over_sigma");
  record.best_rms_over_sigma = value.at("best_rms_over_sigma");
  const bool has_held_out = value.at("has_held_out");
  record.errors = ErrorsFromJson(value, has_held_out);
  record.nuisances = NuisancesFromJson(value.at("nuisances"));
  record.ranking = EffectsFromJson(value.at("ranking"), has_held_out);
  for (const json& entry : value.at("untried"))
    record.untried.push_back({entry.at("effect"), entry.at("why")});
  const json& alternatives = value.at("alternatives");
  record.alternatives = {EffectsFromJson(alternatives.at("effects"), has_held_out),
                         alternatives.at("nuisances_evidence"),
                         alternatives.at("rms_over_sigma_without_both")};
  return record;
}

}  // namespace

std::optional<std::string> PartlyExplainedBy(const DiagnosisRecord& diagnosis) {
  constexpr double kMost = 0.5;
  if (diagnosis.verdict != Verdict::kNotInLibrary || diagnosis.reasons.empty()) return std::nullopt;
  const auto* remains = std::get_if<ResidualRemains>(&diagnosis.reasons.front());
  if (remains == nullptr || !(remains->share > kMost)) return std::nullopt;
  double probability = 0;
  for (const HypothesisProbability& one : diagnosis.decision.probabilities)
    if (one.Contains(remains->effect)) probability += one.probability;
  if (probability < kStatedProbability) return std::nullopt;
  return remains->effect;
}

bool IsDiagnosisOf(const std::string& fit, const std::filesystem::path& folder) {
  const std::filesystem::path origin = folder / "of_fit.json", file = folder / "diagnosis.json";
  if (!std::filesystem::exists(origin) || !std::filesystem::exists(file)) return false;
  return ReadJsonFile(origin, [&](const json& value) {
    return value.value("diagnosis", "") == HashFile(file) &&
           value.value("of", json::object()).value("fit", "") == fit;
  });
}

void WriteDiagnosisFile(const DiagnosisRecord& record, const std::filesystem::path& file) {
  WriteFileAtomically(file, ToJson(record).dump(2) + "\n");
}

DiagnosisRecord ReadDiagnosisFile(const std::filesystem::path& file) {
  const auto read = [&](const json& value) {
    return NamingWhere(file.string(), [&] { return FromJson(value); });
  };
  return ReadJsonFile(file, read, "a diagnosis");
}

}  // namespace lacuna
