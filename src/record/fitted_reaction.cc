#include "record/fitted_reaction.h"

#include <nlohmann/json.hpp>

namespace lacuna {
namespace {

using nlohmann::json;

json MeasureToJson(const ReactionMeasure& measure) {
  return {{"frames", measure.frames},
          {"values", measure.values},
          {"rms_N", measure.rms},
          {"largest_N", measure.largest},
          {"rms_over_sigma", measure.rms_over_sigma}};
}

ReactionMeasure MeasureFromJson(const json& value) {
  return {value.at("frames"), value.at("values"), value.at("rms_N"), value.at("largest_N"),
          value.at("rms_over_sigma")};
}

}  // namespace

json ReactionToJson(const FittedReaction& reaction) {
  return {{"name", reaction.name},
          {"components", reaction.labels},
          {"noise_N", reaction.deviation},
          {"noise_is_estimated", reaction.deviation_is_estimated},
          {"tare_deviation_N", reaction.tare_deviation},
          {"tare_N", reaction.tare},
          {"largest_reading_N", reaction.largest_reading},
          {"in_fit", MeasureToJson(reaction.in_fit)},
          {"held_out", MeasureToJson(reaction.held_out)}};
}

FittedReaction ReactionFromJson(const json& value) {
  FittedReaction reaction;
  reaction.name = value.at("name");
  value.at("components").get_to(reaction.labels);
  reaction.deviation = value.at("noise_N");
  reaction.deviation_is_estimated = value.at("noise_is_estimated");
  reaction.tare_deviation = value.at("tare_deviation_N");
  value.at("tare_N").get_to(reaction.tare);
  reaction.largest_reading = value.at("largest_reading_N");
  reaction.in_fit = MeasureFromJson(value.at("in_fit"));
  reaction.held_out = MeasureFromJson(value.at("held_out"));
  return reaction;
}

}  // namespace lacuna
