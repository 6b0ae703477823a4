#include "prediction/prediction_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace lacuna {

std::vector<ModelParameter> ModelParameters(const std::vector<std::shared_ptr<Effect>>& effects) {
  std::vector<ModelParameter> parameters;
  std::map<std::string, int> seen;
  size_t of_material = 0;
  for (const auto& effect : effects) {
    const EffectCard& card = effect->Card();
    const bool is_material = effect == effects.front();
    const int repeat = ++seen[card.type];
    const Eigen::VectorXd values = effect->Parameters();
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
        shared->places.emplace_back(effect, static_cast<int>(k));
        continue;
      }
      ModelParameter parameter;
      parameter.places.emplace_back(effect, static_cast<int>(k));
      parameter.unit = entry.dimension.unit;
      CalibratedParameter& prior = parameter.prior;
      prior.name = is_material  ? entry.name
                   : repeat > 1 ? fmt::format("{}#{}.{}", card.type, repeat, entry.name)
                                : card.type + "." + entry.name;
      prior.start = value;
      // Open bounds are kept at a distance that no estimate reaches.
      const double margin = 1e-6 * (entry.plausible_max - entry.plausible_min);
      prior.min = entry.bounds.min + (entry.bounds.open_min ? margin : 0);
      prior.max = entry.bounds.max - (entry.bounds.open_max ? margin : 0);
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

void SetParameter(const ModelParameter& parameter, double value) {
  for (const auto& [effect, index] : parameter.places) {
    Eigen::VectorXd values = effect->Parameters();
    values[index] = value;
    effect->SetParameters(values);
  }
}

double Duration(const PredictionStudy& study) {
  double duration = 0;
  for (const PredictedRecording& item : study.recordings)
    duration = std::max(duration, item.recording.times[item.frames.back()] -
                                      item.recording.times[item.frames.front()]);
  return duration;
}

}  // namespace lacuna
