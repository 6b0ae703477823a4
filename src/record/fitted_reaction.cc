#include "record/fitted_reaction.h"

#include <nlohmann/json.hpp>

namespace lacuna {
namespace {

using nlohmann::json;

// The keys of forces end with "_N", those of torques with "_N_m".
std::string Key(const char* name, bool is_torque) {
  return std::string(name) + (is_torque ? "_N_m" : "_N");
}

json MeasureToJson(const ReactionMeasure& measure, bool is_torque) {
  return {{"frames", measure.frames},
          {"values", measure.values},
          {Key("rms", is_torque), measure.rms},
          {Key("largest", is_torque), measure.largest},
          {"rms_over_sigma", measure.rms_over_sigma}};
}

ReactionMeasure MeasureFromJson(const json& value, bool is_torque) {
  return {value.at("frames"), value.at("values"), value.at(Key("rms", is_torque)),
          value.at(Key("largest", is_torque)), value.at("rms_over_sigma")};
}

// Empty where there are none.
json MistakesToJson(const ReadingMistakes& mistakes, bool is_torque) {
  json value = json::object();
  if (mistakes.factor) value["factor"] = *mistakes.factor;
  if (mistakes.offset) value[Key("offset", is_torque)] = *mistakes.offset;
  if (mistakes.delay) value["delay_s"] = *mistakes.delay;
  return value;
}

ReadingMistakes MistakesFromJson(const json& value, bool is_torque) {
  const auto entry = [&](const std::string& key) -> std::optional<double> {
    if (!value.contains(key)) return std::nullopt;
    return value.at(key).get<double>();
  };
  return {entry("factor"), entry(Key("offset", is_torque)), entry("delay_s")};
}

}  // namespace

json ReactionToJson(const FittedReaction& reaction) {
  const bool is_torque = reaction.is_torque;
  return {{"name", reaction.name},
          {"quantity", reaction.Quantity()},
          {"components", reaction.labels},
          {"is_opposite", reaction.is_opposite},
          {Key("noise", is_torque), reaction.deviation},
          {"noise_is_estimated", reaction.deviation_is_estimated},
          {Key("tare_deviation", is_torque), reaction.tare_deviation},
          {Key("tare", is_torque), reaction.tare},
          {Key("largest_reading", is_torque), reaction.largest_reading},
          {"in_fit", MeasureToJson(reaction.in_fit, is_torque)},
          {"held_out", MeasureToJson(reaction.held_out, is_torque)},
          {"likely_mistakes", MistakesToJson(reaction.likely_mistakes, is_torque)}};
}

FittedReaction ReactionFromJson(const json& value) {
  FittedReaction reaction;
  reaction.name = value.at("name");
  // Absent in older records.
  const bool is_torque = value.value("quantity", "force") == "torque";
  reaction.is_torque = is_torque;
  reaction.is_opposite = value.value("is_opposite", false);
  value.at("components").get_to(reaction.labels);
  reaction.deviation = value.at(Key("noise", is_torque));
  reaction.deviation_is_estimated = value.at("noise_is_estimated");
  reaction.tare_deviation = value.at(Key("tare_deviation", is_torque));
  value.at(Key("tare", is_torque)).get_to(reaction.tare);
  reaction.largest_reading = value.at(Key("largest_reading", is_torque));
  reaction.in_fit = MeasureFromJson(value.at("in_fit"), is_torque);
  reaction.held_out = MeasureFromJson(value.at("held_out"), is_torque);
  if (value.contains("likely_mistakes"))  // absent in older records
    reaction.likely_mistakes = MistakesFromJson(value.at("likely_mistakes"), is_torque);
  return reaction;
}

}  // namespace lacuna
