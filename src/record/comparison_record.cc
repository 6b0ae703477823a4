#include "record/comparison_record.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "record/json_vector.h"
#include "record/model_errors.h"
#include "record/schema_version.h"

namespace lacuna {
namespace {

using nlohmann::json;

constexpr int kSchemaVersion = 3;
constexpr const char* kLongerThanData = "longer than the data";

// Writes a correlation time or length, with a string in place of infinity, which JSON does not
// have.
json ScaleToJson(double value) {
  return std::isinf(value) ? json(kLongerThanData) : NumberOrNull(value);
}
double ScaleFromJson(const json& value) {
  return value == kLongerThanData ? std::numeric_limits<double>::infinity() : NumberOr(value);
}

void AddMeanDifference(const MeanDifference& difference, json* object) {
  (*object)["mean_difference_m"] = VectorToJson(difference.mean);
  (*object)["agreement"] = NumberOrNull(difference.agreement);
}
MeanDifference MeanDifferenceFromJson(const json& object) {
  return {VectorFromJson(object.at("mean_difference_m")), NumberOr(object.at("agreement"))};
}

void AddErrorSize(const ErrorSize& error, json* object) {
  (*object)["points"] = error.points;
  (*object)["rms_m"] = NumberOrNull(error.rms);
  (*object)["rms_over_sigma"] = NumberOrNull(error.rms_over_sigma);
  (*object)["rms_over_floor"] = NumberOrNull(error.rms_over_floor);
  (*object)["steady_m"] = NumberOrNull(error.steady);
  (*object)["changing_m"] = NumberOrNull(error.changing);
  (*object)["largest_m"] = NumberOrNull(error.largest);
  (*object)["largest_point"] = error.largest_point;
  (*object)["largest_time_s"] = NumberOrNull(error.largest_time);
  AddMeanDifference(error.mean_difference, object);
}
ErrorSize ErrorSizeFromJson(const json& object) {
  const auto number = [&](const char* key) { return NumberOr(object.at(key)); };
  return {object.at("points"),      number("rms_m"),
          number("rms_over_sigma"), number("rms_over_floor"),
          number("steady_m"),       number("changing_m"),
          number("largest_m"),      object.at("largest_point"),
          number("largest_time_s"), MeanDifferenceFromJson(object)};
}

json TimeCorrelationToJson(const TimeCorrelation& in_time) {
  return {{"lags", in_time.lags},
          {"ljung_box_statistic", NumberOrNull(in_time.statistic)},
          {"lag_one_correlation", NumberOrNull(in_time.lag_one)},
          {"correlation_time_s", ScaleToJson(in_time.time)},
          {"p_value", NumberOrNull(in_time.p_value)}};
}
TimeCorrelation TimeCorrelationFromJson(const json& object) {
  return {object.at("lags"), NumberOr(object.at("ljung_box_statistic")),
          NumberOr(object.at("lag_one_correlation")),
          ScaleFromJson(object.at("correlation_time_s")), NumberOr(object.at("p_value"))};
}

json SpaceCorrelationToJson(const SpaceCorrelation& in_space) {
  json pairs = json::array();
  for (const PointCorrelation& pair : in_space.pairs)
    pairs.push_back({{"points", {pair.first, pair.second}},
                     {"distance_m", NumberOrNull(pair.distance)},
                     {"correlation", NumberOrNull(pair.correlation)}});
  return {{"mean_correlation", NumberOrNull(in_space.mean)},
          {"correlation_length_m", ScaleToJson(in_space.length)},
          {"p_value", NumberOrNull(in_space.p_value)},
          {"pairs", pairs}};
}
SpaceCorrelation SpaceCorrelationFromJson(const json& object) {
  SpaceCorrelation in_space{NumberOr(object.at("mean_correlation")),
                            ScaleFromJson(object.at("correlation_length_m")),
                            NumberOr(object.at("p_value")),
                            {}};
  for (const json& pair : object.at("pairs"))
    in_space.pairs.push_back({pair.at("points").at(0), pair.at("points").at(1),
                              NumberOr(pair.at("distance_m")), NumberOr(pair.at("correlation"))});
  return in_space;
}

json WorstPeriodToJson(const WorstPeriod& period) {
  json object{{"first_frame", period.first_frame},
              {"last_frame", period.last_frame},
              {"frames", period.frames},
              {"from_s", period.from},
              {"to_s", period.to},
              {"rms_m", NumberOrNull(period.rms)}};
  AddMeanDifference(period.mean_difference, &object);
  return object;
}
WorstPeriod WorstPeriodFromJson(const json& object) {
  return {object.at("first_frame"),      object.at("last_frame"), object.at("frames"),
          object.at("from_s"),           object.at("to_s"),       NumberOr(object.at("rms_m")),
          MeanDifferenceFromJson(object)};
}

json TrendToJson(const ErrorTrend& trend) {
  json bins = json::array();
  for (const ErrorBin& bin : trend.bins)
    bins.push_back({{"low", bin.low},
                    {"high", bin.high},
                    {"mean", bin.mean},
                    {"count", bin.count},
                    {"rms_m", bin.rms},
                    {"rms_over_sigma", NumberOrNull(bin.rms_over_sigma)}});
  return {{"quantity", trend.quantity},
          {"rank_correlation", NumberOrNull(trend.rank_correlation)},
          {"bins", bins}};
}
ErrorTrend TrendFromJson(const json& object) {
  ErrorTrend trend{object.at("quantity"), NumberOr(object.at("rank_correlation")), {}};
  for (const json& bin : object.at("bins"))
    trend.bins.push_back({bin.at("low"), bin.at("high"), bin.at("mean"), bin.at("count"),
                          bin.at("rms_m"), NumberOr(bin.value("rms_over_sigma", json()))});
  return trend;
}

json PartToJson(const ComparedPart& part) {
  json object{{"part", part.fitted ? "fitted" : "held out"},
              {"frames", part.frames},
              {"from_s", part.from},
              {"to_s", part.to},
              {"point_rms_m", VectorToJson(part.point_rms)},
              {"worst_point", part.worst_point},
              {"time_correlation", TimeCorrelationToJson(part.in_time)},
              {"space_correlation", SpaceCorrelationToJson(part.in_space)},
              {"worst_period", nullptr},
              {"trends", json::array()}};
  AddErrorSize(part.error, &object);
  object["rms_at_measured_places_m"] = NumberOrNull(part.rms_at_measured_places);
  if (part.worst_period) object["worst_period"] = WorstPeriodToJson(*part.worst_period);
  for (const ErrorTrend& trend : part.trends) object["trends"].push_back(TrendToJson(trend));
  return object;
}
ComparedPart PartFromJson(const json& object) {
  ComparedPart part;
  part.fitted = object.at("part") == "fitted";
  part.frames = object.at("frames");
  part.from = object.at("from_s");
  part.to = object.at("to_s");
  part.error = ErrorSizeFromJson(object);
  part.rms_at_measured_places = NumberOr(object.at("rms_at_measured_places_m"));
  part.point_rms = VectorFromJson(object.at("point_rms_m"));
  part.worst_point = object.at("worst_point");
  part.in_time = TimeCorrelationFromJson(object.at("time_correlation"));
  part.in_space = SpaceCorrelationFromJson(object.at("space_correlation"));
  if (const json& period = object.at("worst_period"); !period.is_null())
    part.worst_period = WorstPeriodFromJson(period);
  for (const json& trend : object.at("trends")) part.trends.push_back(TrendFromJson(trend));
  return part;
}

json NoiseFloorToJson(const NoiseFloor& noise_floor) {
  json rests = json::array();
  for (const RestPeriod& rest : noise_floor.rests)
    rests.push_back({{"from_s", rest.from},
                     {"to_s", rest.to},
                     {"deviation_m", NumberOrNull(rest.deviation)},
                     {"drift_m_per_s", NumberOrNull(rest.drift)},
                     {"noise_drift_m_per_s", NumberOrNull(rest.noise_drift)}});
  return {{"floor_m", NumberOrNull(noise_floor.floor)},
          {"white_noise_m", NumberOrNull(noise_floor.white)},
          {"rest_deviation_m", NumberOrNull(noise_floor.rest_deviation)},
          {"rests", rests}};
}
NoiseFloor NoiseFloorFromJson(const json& object) {
  NoiseFloor noise_floor{NumberOr(object.at("floor_m")),
                         NumberOr(object.at("white_noise_m")),
                         NumberOr(object.at("rest_deviation_m")),
                         {}};
  for (const json& rest : object.at("rests"))
    noise_floor.rests.push_back(
        {rest.at("from_s"), rest.at("to_s"), NumberOr(rest.at("deviation_m")),
         NumberOr(rest.at("drift_m_per_s")), NumberOr(rest.value("noise_drift_m_per_s", json()))});
  return noise_floor;
}

json LoadedMostToJson(const LoadedMost& loaded) {
  return {{"von_mises_Pa", NumberOrNull(loaded.von_mises)},
          {"von_mises_time_s", NumberOrNull(loaded.von_mises_time)},
          {"von_mises_place_m", VectorToJson(loaded.von_mises_place)},
          {"largest_stretch", NumberOrNull(loaded.stretch)},
          {"largest_stretch_time_s", NumberOrNull(loaded.stretch_time)},
          {"largest_stretch_place_m", VectorToJson(loaded.stretch_place)}};
}
LoadedMost LoadedMostFromJson(const json& object) {
  return {NumberOr(object.at("von_mises_Pa")),
          NumberOr(object.at("von_mises_time_s")),
          VectorFromJson(object.at("von_mises_place_m")),
          NumberOr(object.at("largest_stretch")),
          NumberOr(object.at("largest_stretch_time_s")),
          VectorFromJson(object.at("largest_stretch_place_m"))};
}

json RecordingToJson(const ComparedRecording& recording) {
  json parts = json::array(), reactions = json::array();
  for (const FittedReaction& reaction : recording.reactions)
    reactions.push_back(ReactionToJson(reaction));
  for (const ComparedPart& part : recording.parts) parts.push_back(PartToJson(part));
  const bool has_distances = recording.grip_distance.size() > 0;
  return {
      {"name", recording.name},
      {"kind", recording.is_scan ? "scan" : "markers"},
      {"noise_m", recording.noise},
      {"point_names", recording.point_names},
      {"grip_distance_m", has_distances ? VectorToJson(recording.grip_distance) : json()},
      {"noise_floor", NoiseFloorToJson(recording.noise_floor)},
      {"parts", parts},
      {"reactions", reactions},
      {"height_along", recording.height_by_gravity ? "against gravity" : "z"},
      {"field_frames", recording.field_frames},
      {"loaded_most", recording.loaded_most ? LoadedMostToJson(*recording.loaded_most) : json()},
      {"unexplained_force", recording.force ? UnexplainedForceToJson(*recording.force) : json()}};
}
ComparedRecording RecordingFromJson(const json& object) {
  ComparedRecording recording;
  recording.name = object.at("name");
  recording.is_scan = object.at("kind") == "scan";
  recording.noise = object.at("noise_m");
  recording.point_names = object.at("point_names").get<std::vector<std::string>>();
  if (const json& distances = object.at("grip_distance_m"); !distances.is_null())
    recording.grip_distance = VectorFromJson(distances);
  recording.noise_floor = NoiseFloorFromJson(object.at("noise_floor"));
  for (const json& part : object.at("parts")) recording.parts.push_back(PartFromJson(part));
  for (const json& reaction : object.value("reactions", json::array()))
    recording.reactions.push_back(ReactionFromJson(reaction));
  recording.height_by_gravity = object.at("height_along") == "against gravity";
  recording.field_frames = object.at("field_frames");
  if (const json loaded = object.value("loaded_most", json()); !loaded.is_null())
    recording.loaded_most = LoadedMostFromJson(loaded);
  if (const json& force = object.at("unexplained_force"); !force.is_null())
    recording.force = UnexplainedForceFromJson(force);
  return recording;
}

ComparisonRecord RecordFromJson(const json& document) {
  RequireSchemaVersion(document, kSchemaVersion, "lacuna compare");
  ComparisonRecord record;
  record.fit = document.value("fit", "");
  record.noise = document.at("noise_m");
  for (const json& recording : document.at("recordings"))
    record.recordings.push_back(RecordingFromJson(recording));
  for (const json& pair : document.at("pairs"))
    record.pairs.push_back({pair.at("recordings").at(0), pair.at("recordings").at(1),
                            pair.at("frames"), NumberOr(pair.at("delay_s")),
                            NumberOr(pair.at("distance_m"))});
  record.notes = document.at("notes").get<std::vector<std::string>>();
  return record;
}

}  // namespace

double ComparedRecording::RmsOfNoise(double sigma) const {
  return is_scan ? sigma : RmsOfMarkerNoise(sigma);
}

void WriteComparisonFile(const ComparisonRecord& record, const std::vector<std::string>& text,
                         const std::filesystem::path& file) {
  json recordings = json::array(), pairs = json::array();
  for (const ComparedRecording& recording : record.recordings)
    recordings.push_back(RecordingToJson(recording));
  for (const ComparedPair& pair : record.pairs)
    pairs.push_back({{"recordings", {pair.first, pair.second}},
                     {"frames", pair.frames},
                     {"delay_s", NumberOrNull(pair.delay)},
                     {"distance_m", NumberOrNull(pair.distance)}});
  const json document{{"schema_version", kSchemaVersion},
                      {"fit", record.fit},
                      {"noise_m", record.noise},
                      {"recordings", recordings},
                      {"pairs", pairs},
                      {"notes", record.notes},
                      {"text", text}};
  WriteFileAtomically(file, document.dump(2) + "\n");
}

bool IsComparisonOf(const std::string& fit, const std::filesystem::path& file) {
  std::ifstream stream(file);
  const json document = json::parse(stream, nullptr, /*allow_exceptions=*/false);
  return !document.is_object() || !document.contains("fit") || document.at("fit") == fit;
}

ComparisonRecord ReadComparisonFile(const std::filesystem::path& file) {
  const auto read = [&](const json& document) {
    return NamingWhere(file.string(), [&] { return RecordFromJson(document); });
  };
  return ReadJsonFile(file, read, "a comparison");
}

}  // namespace lacuna
