#include "record/calibration_record.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/json_number.h"
#include "record/schema_version.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 4;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

const std::vector<std::pair<Determination, std::string>>& DeterminationNames() {
  static const std::vector<std::pair<Determination, std::string>> names{
      {Determination::kPinnedDown, "pinned down"},
      {Determination::kDead, "dead"},
      {Determination::kFlat, "flat"},
      {Determination::kTradedOff, "traded off"},
      {Determination::kAtBound, "at its bound"}};
  return names;
}

json MeasureToJson(const MisfitMeasure& measure) {
  return {{"frames", measure.frames},
          {"points", measure.points},
          {"rms_m", measure.rms},
          {"largest_m", measure.largest},
          {"rms_over_sigma", measure.rms_over_sigma},
          {"rms_at_measured_places_m", measure.rms_at_measured_places}};
}

MisfitMeasure MeasureFromJson(const json& value) {
  return {value.at("frames"),    value.at("points"),         value.at("rms_m"),
          value.at("largest_m"), value.at("rms_over_sigma"), value.at("rms_at_measured_places_m")};
}

json ScanToJson(const FittedScan& scan) {
  json places = json::array();
  for (Eigen::Index c = 0; c < scan.places.cols(); ++c)
    places.push_back({scan.places(0, c), scan.places(1, c), scan.places(2, c)});
  return {
      {"patch_places_m", places}, {"patch_noise_m", scan.patch_noise}, {"used_share", scan.used}};
}

FittedScan ScanFromJson(const json& value) {
  const json& places = value.at("patch_places_m");
  FittedScan scan{Eigen::Matrix3Xd(3, places.size()), value.at("patch_noise_m"),
                  value.at("used_share")};
  for (size_t c = 0; c < places.size(); ++c)
    for (int axis = 0; axis < 3; ++axis)
      scan.places(axis, static_cast<Eigen::Index>(c)) = places[c].at(axis).get<double>();
  return scan;
}

json ToJson(const CalibrationRecord& record) {
  json parameters = json::array();
  for (const FittedParameter& parameter : record.parameters) {
    parameters.push_back(
        {{"name", parameter.name}, {"unit", parameter.unit}, {"log_scale", parameter.log_scale}});
    parameters.back().update(EstimateToJson(parameter.estimate));
    if (parameter.with_finest_mesh)
      parameters.back()["with_finest_mesh"] = *parameter.with_finest_mesh;
    if (parameter.at_limit) parameters.back()["at_limit"] = *parameter.at_limit;
    if (parameter.shares) parameters.back()["shares"] = ByDataKindToJson(*parameter.shares);
    if (const auto& near = parameter.near_bound)
      parameters.back()["near_bound"] = {{"side", near->is_upper ? "upper" : "lower"},
                                         {"bound", near->bound}};
  }
  json held = json::array();
  for (const HeldParameter& parameter : record.held)
    held.push_back(
        {{"name", parameter.name}, {"unit", parameter.unit}, {"values", parameter.values}});
  json recordings = json::array();
  for (const FittedRecording& recording : record.recordings) {
    json entry = {{"name", recording.name},
                  {"fitted", recording.fitted},
                  {"noise_m", recording.noise},
                  {"in_fit", MeasureToJson(recording.in_fit)},
                  {"held_out", MeasureToJson(recording.held_out)}};
    if (recording.scan) entry["scan"] = ScanToJson(*recording.scan);
    for (const OwnValue& own : recording.own)
      entry["own"].push_back({{"name", own.name}, {"unit", own.unit}, {"value", own.value}});
    for (const FittedReaction& reaction : recording.reactions)
      entry["reactions"].push_back(ReactionToJson(reaction));
    if (!recording.marker_names.empty()) entry["marker_names"] = recording.marker_names;
    recordings.push_back(entry);
  }
  json conflicts = json::array();
  for (const PriorConflict& conflict : record.prior_conflicts)
    conflicts.push_back(PriorConflictToJson(conflict));
  json all = {{"schema_version", kSchemaVersion},
              {"experiment", record.experiment.generic_string()},
              {"usable", record.usable},
              {"message", record.message},
              {"noise_m", record.noise},
              {"time_step_s", record.time_step},
              {"step_error_over_sigma", NumberOrNull(record.step_error)},
              {"rms_before", NumberOrNull(record.start_rms)},
              {"rms_after", NumberOrNull(record.rms)},
              {"predictions", record.predictions},
              {"parameters", parameters},
              {"held", held},
              {"recordings", recordings},
              {"prior_conflicts", conflicts}};
  if (record.scan_noise > 0) all["scan_noise_m"] = record.scan_noise;
  if (!record.notes.empty()) all["notes"] = record.notes;
  return all;
}

CalibrationRecord FromJson(const json& value) {
  RequireSchemaVersion(value, kSchemaVersion, "lacuna fit");
  CalibrationRecord record;
  record.experiment = value.at("experiment").get<std::string>();
  record.usable = value.at("usable");
  record.message = value.at("message");
  record.notes = value.value("notes", std::vector<std::string>());
  record.noise = value.at("noise_m");
  record.time_step = value.at("time_step_s");
  record.step_error = NumberOr(value.at("step_error_over_sigma"), kInfinity);
  record.start_rms = NumberOr(value.at("rms_before"), kInfinity);
  record.rms = NumberOr(value.at("rms_after"), kInfinity);
  record.predictions = value.at("predictions");
  for (const json& entry : value.at("parameters")) {
    FittedParameter parameter;
    parameter.name = entry.at("name");
    parameter.unit = entry.at("unit");
    parameter.log_scale = entry.at("log_scale");
    parameter.estimate = EstimateFromJson(entry);
    if (entry.contains("with_finest_mesh")) parameter.with_finest_mesh = entry["with_finest_mesh"];
    if (entry.contains("at_limit")) parameter.at_limit = entry["at_limit"];
    if (entry.contains("shares")) parameter.shares = ByDataKindFromJson(entry["shares"]);
    if (entry.contains("near_bound"))
      parameter.near_bound = {entry["near_bound"].at("side") == "upper",
                              entry["near_bound"].at("bound")};
    record.parameters.push_back(parameter);
  }
  for (const json& entry : value.at("held"))
    record.held.push_back({entry.at("name"), entry.at("unit"), entry.at("values")});
  record.scan_noise = value.value("scan_noise_m", 0.0);
  for (const json& entry : value.at("recordings")) {
    record.recordings.push_back({entry.at("name"), entry.at("fitted"), entry.at("noise_m"),
                                 MeasureFromJson(entry.at("in_fit")),
                                 MeasureFromJson(entry.at("held_out")), std::nullopt});
    if (entry.contains("scan")) record.recordings.back().scan = ScanFromJson(entry.at("scan"));
    for (const json& own : entry.value("own", json::array()))
      record.recordings.back().own.push_back({own.at("name"), own.at("unit"), own.at("value")});
    for (const json& reaction : entry.value("reactions", json::array()))
      record.recordings.back().reactions.push_back(ReactionFromJson(reaction));
    record.recordings.back().marker_names = entry.value("marker_names", std::vector<std::string>());
  }
  for (const json& conflict : value.at("prior_conflicts"))
    record.prior_conflicts.push_back(PriorConflictFromJson(conflict));
  return record;
}

}  // namespace

std::optional<NearBound> FindNearBound(const ParameterEstimate& estimate, bool log_scale,
                                       double low, double high) {
  constexpr double kNear = 0.01;  // of the distance between the bounds
  const bool is_determined = std::isfinite(estimate.low) && std::isfinite(estimate.high);
  if (!is_determined && estimate.determination != Determination::kAtBound) return std::nullopt;
  const auto scaled = [log_scale](double value) {
    return log_scale ? (value > 0 ? std::log(value) : -kInfinity) : value;
  };
  const double range = scaled(high) - scaled(low);
  const double margin = std::isfinite(range) ? kNear * range : 0;
  const double least =
      std::isfinite(estimate.low) ? std::min(estimate.low, estimate.value) : estimate.value;
  const double most =
      std::isfinite(estimate.high) ? std::max(estimate.high, estimate.value) : estimate.value;
  const bool near_low = std::isfinite(scaled(low)) && scaled(least) <= scaled(low) + margin;
  const bool near_high = std::isfinite(scaled(high)) && scaled(most) >= scaled(high) - margin;
  if (near_low && near_high) return std::nullopt;  // the data do not determine the parameter
  if (near_high) return NearBound{true, high};
  if (near_low) return NearBound{false, low};
  return std::nullopt;
}

bool HasPlannableRecording(const CalibrationRecord& record) {
  return std::any_of(
      record.recordings.begin(), record.recordings.end(),
      [](const FittedRecording& recording) { return recording.fitted && !recording.scan; });
}

std::optional<double> RmsOfNoise(const CalibrationRecord& record) {
  const bool has_scans =
      std::any_of(record.recordings.begin(), record.recordings.end(),
                  [](const FittedRecording& recording) { return recording.scan.has_value(); });
  if (has_scans) return std::nullopt;
  return RmsOfMarkerNoise(record.noise);
}

json EstimateToJson(const ParameterEstimate& estimate) {
  return {{"value", estimate.value},
          {"low_95", NumberOrNull(estimate.low)},
          {"high_95", NumberOrNull(estimate.high)},
          {"deviation_from_data", NumberOrNull(estimate.deviation)},
          {"deviation", NumberOrNull(estimate.posterior_deviation)},
          {"verdict", DeterminationName(estimate.determination)},
          {"most_correlated_with", estimate.traded_with},
          {"correlation", estimate.correlation}};
}

ParameterEstimate EstimateFromJson(const json& value) {
  ParameterEstimate estimate;
  estimate.value = value.at("value");
  estimate.low = NumberOr(value.at("low_95"), -kInfinity);
  estimate.high = NumberOr(value.at("high_95"), kInfinity);
  estimate.deviation = NumberOr(value.at("deviation_from_data"), kInfinity);
  estimate.posterior_deviation = NumberOr(value.at("deviation"), kInfinity);
  for (const auto& [determination, name] : DeterminationNames())
    if (name == value.at("verdict")) estimate.determination = determination;
  estimate.traded_with = value.at("most_correlated_with");
  estimate.correlation = value.at("correlation");
  return estimate;
}

std::string DeterminationName(Determination determination) {
  for (const auto& [value, name] : DeterminationNames())
    if (value == determination) return name;
  return "";
}

void WriteCalibrationFile(const CalibrationRecord& record, const std::filesystem::path& file) {
  WriteFileAtomically(file, ToJson(record).dump(2) + "\n");
}

bool IsCalibrationOfAnotherFormat(const std::filesystem::path& file) {
  std::ifstream stream(file);
  const json document = json::parse(stream, nullptr, /*allow_exceptions=*/false);
  return document.is_object() && document.value("schema_version", json()) != kSchemaVersion;
}

CalibrationRecord ReadCalibrationFile(const std::filesystem::path& file) {
  const auto read = [&](const json& value) {
    return NamingWhere(file.string(), [&] { return FromJson(value); });
  };
  return ReadJsonFile(file, read, "a record of a calibration");
}

}  // namespace lacuna
