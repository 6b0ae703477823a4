#include "record/unexplained_force_record.h"

#include <nlohmann/json.hpp>

#include "record/json_number.h"

namespace lacuna {

using nlohmann::json;

json UnexplainedForceToJson(const UnexplainedForceRecord& record) {
  if (!record.usable) return {{"usable", false}, {"message", record.message}};
  json correlations = json::array();
  for (const ForceCorrelation& entry : record.correlations)
    correlations.push_back(
        {{"quantity", entry.quantity}, {"correlation", NumberToJson(entry.correlation)}});
  return {{"usable", true},
          {"is_significant", record.fit.is_significant},
          {"converged", record.fit.converged},
          {"predictions", record.fit.predictions},
          {"knots", record.fit.knots},
          {"knot_spacing_s", record.fit.knot_spacing},
          {"weight_N", record.net.weight},
          {"rms_N", NumbersToJson(record.net.rms)},
          {"rms_deviation_N", NumbersToJson(record.net.rms_deviation)},
          {"mean_N", NumbersToJson(record.net.mean)},
          {"mean_deviation_N", NumbersToJson(record.net.mean_deviation)},
          {"constant_share", NumberToJson(record.net.constant_share)},
          {"correlations", correlations},
          {"duration_s", NumberToJson(record.work.duration)},
          {"work_J", NumberToJson(record.work.work)},
          {"work_deviation_J", NumberToJson(record.work.deviation)},
          {"mean_power_W", NumberToJson(record.work.mean_power)},
          {"centroid_m", NumbersToJson(record.place.centroid)},
          {"grip_distance_m", NumberToJson(record.place.grip_distance)},
          {"largest_grip_distance_m", NumberToJson(record.place.largest_grip_distance)},
          {"rms_over_sigma_without", NumberToJson(record.fit.rms_over_sigma_without)},
          {"rms_over_sigma_with", NumberToJson(record.fit.rms_over_sigma_with)},
          {"noise_scale", NumberToJson(record.fit.noise_scale)},
          {"log_evidence", NumberToJson(record.fit.log_evidence)}};
}

UnexplainedForceRecord UnexplainedForceFromJson(const json& value) {
  UnexplainedForceRecord record;
  record.usable = value.at("usable");
  if (!record.usable) {
    record.message = value.at("message");
    return record;
  }
  const auto number = [&](const char* key) { return NumberFromJson(value.at(key)); };
  const auto vector = [&](const char* key) -> Eigen::Vector3d {
    const json& list = value.at(key);
    return {NumberFromJson(list.at(0)), NumberFromJson(list.at(1)), NumberFromJson(list.at(2))};
  };
  record.net = {vector("rms_N"),          vector("rms_deviation_N"),
                vector("mean_N"),         vector("mean_deviation_N"),
                number("constant_share"), number("weight_N")};
  record.work = {number("duration_s"), number("work_J"), number("work_deviation_J"),
                 number("mean_power_W")};
  record.place = {vector("centroid_m"), number("grip_distance_m"),
                  number("largest_grip_distance_m")};
  for (const json& entry : value.at("correlations"))
    record.correlations.push_back({entry.at("quantity"), NumberFromJson(entry.at("correlation"))});
  ForceFitSummary& fit = record.fit;
  fit.rms_over_sigma_without = number("rms_over_sigma_without");
  fit.rms_over_sigma_with = number("rms_over_sigma_with");
  fit.log_evidence = number("log_evidence");
  fit.noise_scale = number("noise_scale");
  fit.knots = value.at("knots");
  fit.knot_spacing = number("knot_spacing_s");
  fit.predictions = value.at("predictions");
  fit.converged = value.at("converged");
  fit.is_significant = value.at("is_significant");
  return record;
}

}  // namespace lacuna
