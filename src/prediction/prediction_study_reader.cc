#include "prediction/prediction_study_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "effects/gravity.h"
#include "effects/uniform_density.h"
#include "experiment/listed_regions.h"
#include "experiment/model_reader.h"
#include "prediction/predicted_recording_reader.h"
#include "prediction/recorded_motion.h"

namespace lacuna {
namespace {

// Throws InputError where nothing holds the object: under any load it would have no equilibrium to
// start from. Contacts pass, because several planes may hold it together. `config` is the entry of
// the recording.
void RequireHeldObject(const Config& config, const EffectList& of_study,
                       const PredictedRecording& item) {
  const RecordedObject& object = item.recording.object;
  const auto may_hold = [](const std::shared_ptr<const Effect>& effect) {
    return MayHold(effect->Card());
  };
  if (!object.fixed.empty() || !object.grips.empty() ||
      std::any_of(of_study.begin(), of_study.end(), may_hold) ||
      std::any_of(item.effects.begin(), item.effects.end(), may_hold))
    return;
  config.Fail(
      "recording",
      fmt::format("nothing holds the object{}: {} has neither `fixed` nor `gripped`, and no "
                  "effect of the model is a support (a plane on which it lies does not suffice)",
                  item.hold ? " after its release" : "", item.recording.file.string()));
}

// Throws InputError where one region holds all points along all axes, as where the normal of a
// half-space has the wrong sign: their motion is then that of the region, whatever the model is. A
// measured force may depend on the model even so. `config` is the entry of the recording.
void RequireFreePoints(const Config& config, const PredictedRecording& item) {
  const RecordedObject& object = item.recording.object;
  const Eigen::Matrix3Xd& places = item.recording.markers.places;
  if (item.ShowsScans() || places.cols() == 0 || !object.reactions.empty()) return;
  const auto require_free = [&](const Region& region, AxisSet axes) {
    if (!axes.IsAll()) return;
    for (const auto& place : places.colwise())
      if (!Contains(region, place)) return;
    config.Fail("recording",
                fmt::format("region \"{}\" of {} holds all {} markers or tracked points, so that "
                            "their motion does not depend on the model (a half_space is the side "
                            "to which its `normal` points)",
                            region.name, item.recording.file.string(), places.cols()));
  };
  for (const RecordedSupport& support : object.fixed) require_free(support.region, support.axes);
  for (const RecordedGrip& grip : object.grips) require_free(grip.region, grip.axes);
}

// Throws InputError where all markers rest at their places on the undeformed object, because such
// recordings determine no parameter.
void RequireSomethingToFit(const Config& config, const PredictionStudy& study) {
  if (!IsAtRest(study)) return;
  double deformation = 0;
  for (const PredictedRecording& item : study.recordings)
    if (item.fitted) deformation = std::max(deformation, RestDeformation(item));
  constexpr double kCertain = 3;  // standard deviations of a marker's place
  if (deformation > kCertain * study.place_deviation) return;
  config.Fail("recordings",
              fmt::format("nothing moves in the frames that are fitted, and no marker is farther "
                          "than {:.2g} mm from its place on the undeformed object "
                          "(place_deviation is {:.2g} mm): there is nothing to fit a model to",
                          1e3 * deformation, 1e3 * study.place_deviation));
}

// Reads the prior of a parameter: `mean`, by default the start value, `deviation`, which is divided
// by the mean for a parameter on a logarithmic scale, and `prior`, which says where they are from.
void ReadPrior(const Config& item, const ParameterCard& card, CalibratedParameter* prior) {
  if (!item.Has("deviation")) {
    for (const char* key : {"mean", "prior"})
      if (item.Has(key)) item.Fail(key, "needs a `deviation` beside it");
    return;
  }
  // Not read where it is absent, so that the configuration of other experiments stays the same.
  prior->has_default_prior =
      item.Has("prior") && item.Choice<bool>("prior", {{"given", false}, {"default", true}});
  prior->prior_mean = item.Quantity("mean", card.dimension, card.bounds, prior->start);
  if (prior->log_scale && !(prior->prior_mean > 0))
    item.Fail("mean", "must be positive: the parameter is fitted on a logarithmic scale");
  const double deviation = item.Quantity("deviation", card.dimension, kPositive);
  prior->prior_deviation = prior->log_scale ? deviation / prior->prior_mean : deviation;
}

// Reads `min` and `max`.
void ReadBounds(const Config& item, const ParameterCard& card, CalibratedParameter* prior) {
  const double min = item.Quantity("min", card.dimension, card.bounds, prior->min);
  const double max = item.Quantity("max", card.dimension, card.bounds, prior->max);
  SetBounds(min, max, card.bounds, prior);
  if (prior->min > prior->max) item.Fail("min", "is above max");
}

// Reads `fit: {parameters: [{name: young_modulus, min: 1 kPa}, …]}`. If it is absent, the
// parameters of the material are fitted.
std::vector<ModelParameter> ReadFitted(const Config& config, const EffectList& effects,
                                       const BodyScale& body) {
  const std::vector<ModelParameter> known = ModelParameters(effects, body);
  const auto fit = config.OptionalChild("fit");
  if (!fit) {
    std::vector<ModelParameter> of_material;
    for (const ModelParameter& parameter : known)
      if (parameter.places.front().effect == 0) of_material.push_back(parameter);
    return of_material;
  }
  std::vector<std::pair<std::string, const ModelParameter*>> choices;
  for (const ModelParameter& parameter : known)
    choices.emplace_back(parameter.prior.name, &parameter);
  std::vector<ModelParameter> fitted;
  for (const Config& item : fit->Items("parameters")) {
    ModelParameter parameter = *item.Choice("name", choices);
    for (const ModelParameter& earlier : fitted)
      if (earlier.prior.name == parameter.prior.name) item.Fail("name", "is listed twice");
    CalibratedParameter& prior = parameter.prior;
    const auto [effect, index] = parameter.places.front();
    const ParameterCard& card = effects[effect]->Card().parameters[index];
    ReadBounds(item, card, &prior);
    if (!(prior.min <= prior.start && prior.start <= prior.max))
      item.Fail("name", fmt::format("starts at {:g} {}, outside {:g} to {:g}", prior.start,
                                    parameter.unit, prior.min, prior.max));
    ReadPrior(item, card, &prior);
    fitted.push_back(parameter);
  }
  return fitted;
}

// The weight of a mass in one recording alone does not follow a gravity that is fitted.
void RequireKnownWeights(const Config& config, const PredictionStudy& study) {
  for (const ModelParameter& parameter : study.fitted) {
    if (!IsGravity(EffectOf(parameter, study.effects))) continue;
    for (const PredictedRecording& item : study.recordings)
      for (const auto& effect : item.effects)
        if (const auto gravity = GravitySettingOf(*effect); gravity && !gravity->isZero(0))
          config.Fail("fit", fmt::format("{} cannot be fitted: the weight of {} among the effects "
                                         "of {} would stay the same; list it in the `effects` of "
                                         "the experiment, or hold gravity fixed",
                                         parameter.prior.name, effect->Card().type, item.name));
  }
}

// Makes the density a parameter of the fit where `density_deviation` is given. Its weight is that
// of the model's gravity, which must therefore be known and the same in all recordings.
void AddDensity(const Config& config, PredictionStudy* study) {
  constexpr double kLargestFactor = 10;  // of the density, either way: bounds far beyond the prior
  // Not read where it is absent, so that the configuration of other experiments stays the same.
  if (!config.Has("density_deviation")) return;
  study->density_deviation = config.Number("density_deviation", Bounds{0, 0.5});
  if (study->density_deviation == 0) return;
  for (const ModelParameter& parameter : study->fitted)
    if (IsGravity(EffectOf(parameter, study->effects)))
      config.Fail("density_deviation",
                  fmt::format("cannot be combined with a fitted {}: the weight of the object is "
                              "the product of both",
                              parameter.prior.name));
  for (const PredictedRecording& item : study->recordings)
    if (GravityOf(item.effects))
      config.Fail("density_deviation",
                  fmt::format("needs gravity in the list `effects` of the experiment, not in that "
                              "of {}",
                              item.name));
  study->effects.push_back(MakeUniformDensity(
      study->density, GravityOf(study->effects).value_or(Eigen::Vector3d::Zero())));
  ModelParameter parameter = ModelParameters(study->effects, ScaleOf(*study)).back();
  CalibratedParameter& prior = parameter.prior;
  prior.name = "density";
  const int index = parameter.places.front().index;
  SetBounds(study->density / kLargestFactor, study->density * kLargestFactor,
            study->effects.back()->Card().parameters[index].bounds, &prior);
  prior.prior_mean = study->density;
  prior.prior_deviation = prior.typical = study->density_deviation;
  prior.has_default_prior = false;
  study->fitted.push_back(parameter);
}

// Sets to which nodes the lists of each recording refer: to those of its own reference, or, where
// it has none, to those of the first recording, whose reference shape is meshed.
void NumberListsOfRecordings(PredictionStudy* study) {
  for (PredictedRecording& item : study->recordings) {
    const bool has_reference = item.recording.reference.source != ReferenceSource::kFirstFrame;
    NumberListedNodes(has_reference ? item.recording : study->recordings.front().recording,
                      study->mesh, RegionsIn(&item));
  }
}

constexpr double kLongestStep = 0.005;  // s, largest initial time step
constexpr double kMostSteps = 1e6;

// The smallest mean time between used frames, s, of any recording.
double ShortestSpacing(const std::vector<PredictedRecording>& recordings) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const PredictedRecording& item : recordings) {
    const std::vector<double>& times = item.recording.times;
    if (item.frames.size() < 2) continue;
    shortest = std::min(shortest, (times[item.frames.back()] - times[item.frames.front()]) /
                                      static_cast<double>(item.frames.size() - 1));
  }
  return shortest;
}

// The initial time step, s, of the fit. Quasi-static steps end at the frames in any case.
double FirstStep(const PredictionStudy& study) {
  const double spacing = ShortestSpacing(study.recordings);
  if (study.scheme != TimeScheme::kQuasiStatic) return std::min(kLongestStep, 0.5 * spacing);
  return std::isfinite(spacing) ? spacing : kLongestStep;
}

// Throws InputError where the time step is too large to resolve the motion, or so small that a fit
// would take too long.
void RequireSoundStep(const Config& motion, const PredictionStudy& study) {
  constexpr double kFewest = 10;
  const double duration = Duration(study), steps = duration / study.time_step;
  const double fewest = study.scheme == TimeScheme::kQuasiStatic ? 0 : kFewest;
  if (steps < fewest || steps > kMostSteps)
    motion.Fail("time_step",
                fmt::format("makes {:.3g} steps of the {:g} s that are predicted; {:g} to {:g} are "
                            "allowed",
                            steps, duration, fewest, kMostSteps));
}

}  // namespace

bool IsPredictionStudy(const Config& config) { return config.Has("recordings"); }

PredictionStudy ReadPredictionStudy(const Config& config) {
  PredictionStudy study;
  if (!IsPredictionStudy(config) && config.Has("recording"))
    config.Fail("recording",
                "makes this an experiment for `lacuna reconstruct`; a prediction has "
                "a list of `recordings`");
  config.Integer("schema_version", 1, 1);
  study.file = config.File();
  study.name = config.Name("name");
  study.output = config.Path("output", "../results/" + study.name);
  const Config mesh = config.Child("mesh");
  study.mesh = ReadMeshSettings(mesh);
  study.sheet_layers = mesh.Integer("sheet_layers", 1, 100, study.sheet_layers);
  study.effects = ReadEffects(config);
  study.candidates = ReadCandidates(config, study.effects.front().get());
  const std::optional<Config> motion = config.OptionalChild("motion");
  if (motion) study.scheme = ReadTimeScheme(*motion, "two_step");
  study.chooses_time_step = !motion || !motion->Has("time_step");
  if (!study.chooses_time_step) study.time_step = motion->Quantity("time_step", kTime, kPositive);
  study.noise = config.Quantity("noise", kLength, kNotNegative, study.noise);
  study.place_deviation_is_given = config.Has("place_deviation");
  study.place_deviation =
      config.Quantity("place_deviation", kLength, kNotNegative, study.place_deviation);
  study.size_deviation = config.Number("size_deviation", Bounds{0, 0.2}, study.size_deviation);
  study.explained_misfit = config.Number("explained_misfit", kNotNegative, study.explained_misfit);
  study.scan = ReadScanSettings(config);
  for (const Config& item : config.Items("recordings")) {
    PredictedRecording recording =
        ReadRecordingEntry(item, study.effects, study.scan, study.scheme,
                           /*defines_body_shape=*/study.recordings.empty());
    for (const PredictedRecording& other : study.recordings)
      if (other.name == recording.name)
        item.Fail("name", fmt::format("\"{}\" is already the name of another recording; an entry "
                                      "without a name has that of its recording",
                                      recording.name));
    RequireHeldObject(item, study.effects, recording);
    RequireFreePoints(item, recording);
    study.recordings.push_back(std::move(recording));
  }
  if (study.recordings.empty()) config.Fail("recordings", "is empty");
  NumberListsOfRecordings(&study);
  if (std::none_of(study.recordings.begin(), study.recordings.end(),
                   [](const PredictedRecording& item) { return item.fitted; }))
    config.Fail("recordings", "none of them is fitted");
  RequireSomethingToFit(config, study);
  if (study.chooses_time_step)
    study.time_step = FirstStep(study);
  else
    RequireSoundStep(*motion, study);
  if (study.chooses_time_step && Duration(study) > kMostSteps * study.time_step)
    config.Fail(
        "recordings",
        fmt::format("last {:g} s, for which a motion with inertia takes millions of steps: give "
                    "`motion: {{scheme: quasi_static}}`, a shorter `to`, or a time_step",
                    Duration(study)));
  const auto& density = study.recordings.front().recording.object.density;
  study.density = density ? config.Quantity("density", kDensity, kPositive, *density)
                          : config.Quantity("density", kDensity, kPositive);
  study.fitted = ReadFitted(config, study.effects, ScaleOf(study));
  RequireKnownWeights(config, study);
  AddDensity(config, &study);
  config.RefuseUnknownKeys();
  study.configuration = config.Resolved();
  return study;
}

}  // namespace lacuna
