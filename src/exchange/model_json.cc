#include "exchange/model_json.h"

#include <nlohmann/json.hpp>

namespace lacuna {
namespace {

using Json = nlohmann::ordered_json;
using How = Counterpart::Kind;

// The columns of a matrix as lists.
template <typename Matrix>
Json Columns(const Matrix& matrix) {
  Json columns = Json::array();
  for (Eigen::Index k = 0; k < matrix.cols(); ++k)
    columns.push_back(std::vector<double>(matrix.col(k).begin(), matrix.col(k).end()));
  return columns;
}

Json EffectJson(const PortableEffect& effect) {
  Json values = Json::object();
  for (Eigen::Index k = 0; k < effect.values.size(); ++k)
    values[effect.value_names[static_cast<size_t>(k)]] = effect.values[k];
  Json json{{"type", effect.name}, {"parameters", values}};
  if (!effect.yaml.empty()) json["yaml"] = effect.yaml;
  return json;
}

Json GripJson(const PortableGrip& grip) {
  Json json{{"name", grip.part.name}, {"nodes", grip.part.nodes}};
  if (!grip.axes.IsAll())
    for (int axis = 0; axis < 3; ++axis)
      if (grip.axes.Has(axis)) json["axes"].push_back(std::string(1, "xyz"[axis]));
  if (grip.displacements.empty()) return json;
  const bool is_translation = grip.IsTranslation();
  Json motion = Json::array();
  for (const Eigen::Matrix3Xd& at : grip.displacements)
    motion.push_back(is_translation ? Columns(at.leftCols(1)).front() : Columns(at));
  json[is_translation ? "displacement" : "displacements_of_nodes"] = motion;
  return json;
}

Json LoadJson(const PortableLoad& load) {
  return {{"name", load.part.name},
          {"nodes", load.part.nodes},
          {"shares", std::vector<double>(load.shares.begin(), load.shares.end())},
          {"force", Columns(load.force)}};
}

Json ParameterJson(const PortableParameter& parameter) {
  Json json{{"name", parameter.name}, {"unit", parameter.unit}};
  if (parameter.values.size() == 1)
    json["value"] = parameter.values.front();
  else
    json["values"] = parameter.values;
  if (parameter.fitted) json["interval_95"] = {parameter.low, parameter.high};
  if (parameter.at_limit) json["at_limit"] = *parameter.at_limit;
  json["fitted"] = parameter.fitted;
  return json;
}

}  // namespace

Counterparts JsonCounterparts(const PortableModel& model) {
  Counterparts parts;
  for (const PortableEffect& effect : model.effects)
    parts.push_back({effect.name, How::kExact,
                     effect.yaml.empty() ? "name and parameters in model.json"
                                         : "name, parameters and expressions in model.json"});
  for (const PortableGrip& grip : model.grips)
    parts.push_back({"grip " + grip.part.name, How::kExact, "model.json"});
  for (const PortableLoad& load : model.loads)
    parts.push_back({"force " + load.part.name, How::kExact, "model.json"});
  if (model.held_force.size() > 0) parts.push_back({"hold", How::kExact, "model.json"});
  return parts;
}

nlohmann::ordered_json ModelJson(const PortableModel& model, const std::string& mesh_file) {
  Json json{{"schema_version", 1},
            {"program", "lacuna " + model.program_version},
            {"run", model.run},
            {"experiment", model.experiment},
            {"recording", model.recording},
            {"units", "m, kg, s, N, Pa; nodes are numbered from 0"},
            {"mesh", mesh_file},
            {"density", model.density}};
  json["motion"] = {{"kind", model.is_static ? "quasi-static" : "dynamic"},
                    {"start_on_the_clock_of_the_model", model.start},
                    {"time_step", model.time_step},
                    {"times", model.times},
                    {"frames", model.frames}};
  for (const char* list : {"effects", "regions", "grips", "forces", "fit"})
    json[list] = Json::array();
  for (const PortableEffect& effect : model.effects) json["effects"].push_back(EffectJson(effect));
  for (const NamedNodes& region : model.regions)
    json["regions"].push_back({{"name", region.name}, {"nodes", region.nodes}});
  for (const PortableGrip& grip : model.grips) json["grips"].push_back(GripJson(grip));
  for (const PortableLoad& load : model.loads) json["forces"].push_back(LoadJson(load));
  if (model.held_force.size() > 0) json["force_before_the_start"] = Columns(model.held_force);
  for (const PortableParameter& parameter : model.parameters)
    json["fit"].push_back(ParameterJson(parameter));
  return json;
}

}  // namespace lacuna
