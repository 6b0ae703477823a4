#include "prediction/prediction_study.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "effects/gravity.h"
#include "effects/uniform_density.h"

namespace lacuna {
namespace {

// Whether an effect may take a value that the user omits from the material: parameters without a
// default (ReadParameters in effects/catalogue.h).
bool MayFollowMaterial(const ParameterCard& card) { return std::isnan(card.default_value); }

// Sets the bounds to those of the card. The parameter must stay strictly inside an open bound: the
// margin is a part of the distance of its start, however small that is. A Poisson's ratio keeps a
// larger one: near 0.5 a prediction takes many times longer, and the motion hardly changes any
// more.
void SetBoundsOfCard(const Bounds& card, CalibratedParameter* prior) {
  constexpr double kMargin = 0.02, kMarginOfLogScale = 1e-6;
  const double margin = prior->log_scale ? kMarginOfLogScale : kMargin;
  SetBounds(card.open_min ? card.min + margin * (prior->start - card.min) : card.min,
            card.open_max ? card.max - margin * (card.max - prior->start) : card.max, card, prior);
}

// An added mass weighs with the gravity of the model (effects/gravity.h), also where that is
// fitted.
void ShareGravity(const EffectList& effects, std::vector<ModelParameter>* parameters) {
  const std::optional<Eigen::Vector3d> gravity = GravityOf(effects);
  if (!gravity) return;
  for (size_t at = 0; at < effects.size(); ++at) {
    const std::optional<Eigen::Vector3d> setting = GravitySettingOf(*effects[at]);
    if (!setting || !IsSameGravity(*setting, *gravity)) continue;
    for (ModelParameter& parameter : *parameters) {
      const auto [effect, axis] = parameter.places.front();
      if (IsGravity(*effects[effect]))
        parameter.places.push_back({at, GravitySettingOn(effects[at]->Card()) + axis});
    }
  }
}

}  // namespace

std::vector<int> PredictedRecording::FittedFrames() const {
  std::vector<int> chosen;
  for (const int frame : frames)
    if (IsFitted(frame)) chosen.push_back(frame);
  return chosen;
}

std::vector<Region*> RegionsIn(PredictedRecording* item) {
  std::vector<Region*> regions = RegionsIn(&item->recording.object);
  if (item->hold) regions.push_back(&item->hold->region);
  return regions;
}

std::vector<ModelParameter> ModelParameters(const EffectList& effects, const BodyScale& body) {
  std::vector<ModelParameter> parameters;
  std::map<std::string, int> seen;
  size_t of_material = 0;
  for (size_t at = 0; at < effects.size(); ++at) {
    const EffectCard& card = effects[at]->Card();
    const bool is_material = at == 0;
    const int repeat = ++seen[card.type];
    const Eigen::VectorXd values = effects[at]->Parameters();
    for (size_t k = 0; k < card.parameters.size(); ++k) {
      const ParameterCard entry = PlausibleIn(body, card.parameters[k]);
      const double value = values[static_cast<Eigen::Index>(k)];
      const auto end_of_material =
          parameters.begin() + static_cast<std::ptrdiff_t>(is_material ? 0 : of_material);
      const auto shared =
          std::find_if(parameters.begin(), end_of_material, [&](const ModelParameter& other) {
            return other.prior.name == entry.name && other.prior.start == value;
          });
      if (shared != end_of_material && MayFollowMaterial(entry)) {
        shared->places.push_back({at, static_cast<int>(k)});
        continue;
      }
      if (entry.setting) continue;
      ModelParameter parameter;
      parameter.places.push_back({at, static_cast<int>(k)});
      parameter.unit = entry.dimension.unit;
      CalibratedParameter& prior = parameter.prior;
      prior.name = is_material  ? entry.name
                   : repeat > 1 ? fmt::format("{}#{}.{}", card.type, repeat, entry.name)
                                : card.type + "." + entry.name;
      prior.start = value;
      prior.log_scale = entry.log_scale && value > 0;
      SetBoundsOfCard(entry.bounds, &prior);
      prior.typical = prior.log_scale ? 0.5 * std::log(entry.plausible_max / entry.plausible_min)
                                      : 0.5 * (entry.plausible_max - entry.plausible_min);
      prior.prior_deviation = prior.typical;
      prior.has_default_prior = true;
      parameters.push_back(parameter);
    }
    if (is_material) of_material = parameters.size();
  }
  ShareGravity(effects, &parameters);
  return parameters;
}

const Effect& EffectOf(const ModelParameter& parameter, const EffectList& effects) {
  return *effects[parameter.places.front().effect];
}

bool IsDensity(const ModelParameter& parameter, const EffectList& effects) {
  return IsUniformDensity(EffectOf(parameter, effects));
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

BodyScale ScaleOf(const PredictionStudy& study) {
  CHECK(!study.recordings.empty());
  const double length = study.recordings.front().recording.size;
  CHECK_GT(length, 0) << "the reader of the recording has measured it";
  return {YoungModulusOf(study.effects), study.density, length};
}

double Duration(const PredictionStudy& study) {
  double duration = 0;
  for (const PredictedRecording& item : study.recordings)
    duration = std::max(duration, item.recording.times[item.frames.back()] -
                                      item.recording.times[item.frames.front()]);
  return duration;
}

}  // namespace lacuna
