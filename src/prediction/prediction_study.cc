#include "prediction/prediction_study.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "effects/uniform_density.h"

namespace lacuna {

std::vector<ModelParameter> ModelParameters(const EffectList& effects) {
  std::vector<ModelParameter> parameters;
  std::map<std::string, int> seen;
  size_t of_material = 0;
  for (size_t at = 0; at < effects.size(); ++at) {
    const EffectCard& card = effects[at]->Card();
    const bool is_material = at == 0;
    const int repeat = ++seen[card.type];
    const Eigen::VectorXd values = effects[at]->Parameters();
    for (size_t k = 0; k < card.parameters.size(); ++k) {
      const ParameterCard& entry = card.parameters[k];
      const double value = values[static_cast<Eigen::Index>(k)];
      if (entry.setting) continue;
      const auto shared = std::find_if(
          parameters.begin(), parameters.begin() + static_cast<std::ptrdiff_t>(of_material),
          [&](const ModelParameter& other) {
            return other.prior.name == entry.name && other.prior.start == value;
          });
      if (!is_material && shared != parameters.begin() + static_cast<std::ptrdiff_t>(of_material)) {
        shared->places.push_back({at, static_cast<int>(k)});
        continue;
      }
      ModelParameter parameter;
      parameter.places.push_back({at, static_cast<int>(k)});
      parameter.unit = entry.dimension.unit;
      CalibratedParameter& prior = parameter.prior;
      prior.name = is_material  ? entry.name
                   : repeat > 1 ? fmt::format("{}#{}.{}", card.type, repeat, entry.name)
                                : card.type + "." + entry.name;
      prior.start = value;
      // The parameter must stay strictly inside an open bound.
      const double margin = 1e-6 * (entry.plausible_max - entry.plausible_min);
      prior.min = entry.bounds.min + (entry.bounds.open_min ? margin : 0);
      prior.max = entry.bounds.max - (entry.bounds.open_max ? margin : 0);
      prior.open_min = entry.bounds.open_min;
      prior.open_max = entry.bounds.open_max;
      prior.log_scale = entry.log_scale && value > 0;
      prior.typical = prior.log_scale ? 0.5 * std::log(entry.plausible_max / entry.plausible_min)
                                      : 0.5 * (entry.plausible_max - entry.plausible_min);
      prior.prior_deviation = prior.typical;
      parameters.push_back(parameter);
    }
    if (is_material) of_material = parameters.size();
  }
  return parameters;
}

bool IsDensity(const ModelParameter& parameter, const EffectList& effects) {
  return IsUniformDensity(*effects[parameter.places.front().effect]);
}

EffectList WithValues(const EffectList& effects, const std::vector<ModelParameter>& parameters,
                      const Eigen::VectorXd& values) {
  CHECK_GE(values.size(), static_cast<Eigen::Index>(parameters.size()));
  std::vector<Eigen::VectorXd> of_effect(effects.size());
  for (size_t k = 0; k < parameters.size(); ++k) {
    for (const ModelParameter::Place& place : parameters[k].places) {
      Eigen::VectorXd& changed = of_effect[place.effect];
      if (changed.size() == 0) changed = effects[place.effect]->Parameters();
      changed[place.index] = values[static_cast<Eigen::Index>(k)];
    }
  }
  EffectList with = effects;
  for (size_t j = 0; j < with.size(); ++j)
    if (of_effect[j].size() > 0) with[j] = with[j]->WithParameters(of_effect[j]);
  return with;
}

double PlaceDeviation(const PredictionStudy& study, const PredictedRecording& item, double noise) {
  const bool is_read_off_frame =
      HasTrackedPoints(item.recording) && !study.place_deviation_is_given;
  return is_read_off_frame ? noise : study.place_deviation;
}

double Duration(const PredictionStudy& study) {
  double duration = 0;
  for (const PredictedRecording& item : study.recordings)
    duration = std::max(duration, item.recording.times[item.frames.back()] -
                                      item.recording.times[item.frames.front()]);
  return duration;
}

}  // namespace lacuna
