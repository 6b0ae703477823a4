#include "study/prediction_study.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "effects/catalogue.h"
#include "study/recorded_motion.h"
#include "study/tracked_points.h"

namespace lacuna {
namespace {

constexpr double kForever = std::numeric_limits<double>::infinity();

std::vector<int> FramesWithin(const Recording& recording, double from, double to, int every) {
  std::vector<int> frames;
  for (int frame = 0; frame < recording.FrameCount(); ++frame)
    if (recording.times[frame] >= from && recording.times[frame] <= to) frames.push_back(frame);
  std::vector<int> chosen;
  for (size_t k = 0; k < frames.size(); k += every) chosen.push_back(frames[k]);
  return chosen;
}

Hold ReadHold(const Config& config, const Recording& recording) {
  Hold hold{ReadRegion(config.Child("region"), recording.data.folder, "hold"),
            config.Quantity("release", kTime, kAnyValue)};
  if (hold.release > recording.times.back()) {
    config.Fail("release", fmt::format("lies after the recording's last frame, at {:g} s",
                                       recording.times.back()));
  }
  if (hold.release < recording.times.front()) {
    config.Fail("release", fmt::format("lies before the recording's first frame, at {:g} s: no "
                                       "frame shows the object held",
                                       recording.times.front()));
  }
  return hold;
}

// Of the markers that are seen in both.
double LargestMove(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  double largest = 0;
  for (Eigen::Index m = 0; m < from.cols(); ++m) {
    const double move = (to.col(m) - from.col(m)).norm();
    if (move > largest) largest = move;
  }
  return largest;
}

// Without a hold the first frame must be an equilibrium. A body that already moves is not: its
// first step is a good part of all its motion, and more than the least step of any two frames,
// which is noise or a turning point.
void RequireStartAtRest(const Config& config, const PredictedRecording& item) {
  constexpr double kLarge = 0.25, kBeyondNoise = 3;
  const Recording& recording = item.recording;
  if (item.hold || item.scans != nullptr || item.frames.size() < 3) return;
  const auto& positions = recording.markers.positions;
  const Eigen::Matrix3Xd& first = positions[item.frames[0]];
  const double step = LargestMove(first, positions[item.frames[1]]);
  double farthest = 0, least = std::numeric_limits<double>::infinity();
  for (size_t k = 1; k < item.frames.size(); ++k) {
    const Eigen::Matrix3Xd& here = positions[item.frames[k]];
    farthest = std::max(farthest, LargestMove(first, here));
    if (k > 1) least = std::min(least, LargestMove(positions[item.frames[k - 1]], here));
  }
  if (step > kLarge * farthest && step > kBeyondNoise * least)
    config.Fail("recording",
                "the object moves already between its first two frames; a prediction starts from "
                "rest: give `from:`, or `hold:`");
}

// What markers must be told with, and scans.
void CheckObserved(const Config& config, const PredictedRecording& item, bool tells_the_shape) {
  const Recording& recording = item.recording;
  const bool of_first_frame = recording.reference.source == ReferenceSource::kFirstFrame;
  const bool is_tracked = HasTrackedPoints(recording);
  if (is_tracked && item.hold)
    config.Fail("hold",
                "tracked points sit on the object where the first frame shows them, so it may not "
                "be held out of shape there");
  if (item.scans == nullptr) {
    if (!recording.markers.places.allFinite())
      config.Fail("recording",
                  "lacks marker_places: where each marker sits on the undeformed object");
    if (of_first_frame && !is_tracked)
      config.Fail("recording", "has no reference shape: markers alone do not tell it");
    for (const RecordedGrip& grip : recording.object.grips)
      if (grip.motion == GripMotion::kFollowsScan)
        config.Fail("recording",
                    fmt::format("{} is to follow the scan, but there are only markers: "
                                "give `follows_markers` or a `path`",
                                grip.region.name));
    return;
  }
  for (const RecordedGrip& grip : recording.object.grips)
    if (grip.deforms)
      config.Fail("recording",
                  fmt::format("{} is to deform with the scan, whose points are not told "
                              "apart: only markers and tracked points tell that",
                              grip.region.name));
  if (tells_the_shape && of_first_frame && item.hold) {
    config.Fail("hold",
                "the recording's reference shape is its first frame, in which the object is held "
                "out of shape: give a `reference` mesh");
  }
}

void RequireGripPaths(const Config& config, const PredictedRecording& item) {
  const double first = item.recording.times[item.frames.front()];
  const double last = item.recording.times[item.frames.back()];
  for (const RecordedGrip& grip : item.recording.object.grips) {
    const Eigen::Index end = grip.times.size() - 1;
    if (grip.motion == GripMotion::kGiven && (grip.times[0] > first || grip.times[end] < last))
      config.Fail("recording",
                  fmt::format("{} covers {:g} s to {:g} s, the frames {:g} s to {:g} s",
                              grip.file.string(), grip.times[0], grip.times[end], first, last));
  }
}

PredictedRecording ReadRecordingEntry(const Config& config, const Effect* material,
                                      const ScanSettings& scan, TimeScheme scheme,
                                      bool tells_the_shape) {
  PredictedRecording item;
  item.recording = LoadRecording(config.Path("recording"));
  item.name = config.Text("name", item.recording.name);
  if (IsScan(item.recording)) item.scans = std::make_shared<const ScanFrames>(item.recording, scan);
  const double from = config.Quantity("from", kTime, kAnyValue, item.recording.times.front());
  const double to = config.Quantity("to", kTime, kAnyValue, item.recording.times.back());
  item.frames = FramesWithin(item.recording, from, to, config.Integer("every", 1, 1000000, 1));
  item.fitted = config.Flag("fitted", true);
  item.fit_until = config.Quantity("fit_until", kTime, kAnyValue, kForever);
  item.clock_deviation = config.Quantity("clock_deviation", kTime, kNotNegative, 0);
  if (const auto registration = config.OptionalChild("registration")) {
    if (item.scans != nullptr)
      config.Fail("registration", "is known for markers only, not for scans");
    item.shift_deviation = registration->Quantity("shift_deviation", kLength, kPositive);
    item.turn_deviation = registration->Quantity("turn_deviation", kAngle, kPositive);
  }
  if (const auto hold = config.OptionalChild("hold")) item.hold = ReadHold(*hold, item.recording);
  for (const Config& effect : config.Items("effects"))
    item.effects.push_back(MakeEffect(effect, material));

  // An equilibrium tells of itself; a motion does with two steps.
  const size_t fewest = scheme == TimeScheme::kQuasiStatic ? 1 : 3;
  if (item.frames.size() < fewest) {
    config.Fail("recording",
                fmt::format("{} frames lie between {:g} s and {:g} s; at least {} are needed",
                            item.frames.size(), from, to, fewest));
  }
  if (item.fitted && item.fit_until < item.recording.times[item.frames[fewest - 1]])
    config.Fail("fit_until", fmt::format("leaves fewer than {} frames to fit", fewest));
  if (HasTrackedPoints(item.recording)) SeeAsMarkers(item.frames, &item.recording);
  CheckObserved(config, item, tells_the_shape);
  if (scheme == TimeScheme::kQuasiStatic) {
    if (item.hold)
      config.Fail("hold", "what is let go of swings: motion.scheme may not be quasi_static");
  } else {
    RequireStartAtRest(config, item);
  }
  RequireGripPaths(config, item);
  for (const MeasuredForce& force : item.recording.object.forces) {
    const double first = item.recording.times[item.frames.front()];
    const double last = item.recording.times[item.frames.back()];
    if (!force.region)
      config.Fail("recording", "does not tell where " + force.name + " acts (its region)");
    const Eigen::Index end = force.times.size() - 1;
    if (!force.file.empty() && (force.times[0] > first || force.times[end] < last))
      config.Fail("recording",
                  fmt::format("{} covers {:g} s to {:g} s, the frames {:g} s to {:g} s",
                              force.file.string(), force.times[0], force.times[end], first, last));
  }
  return item;
}

// Markers that rest where they sit on the undeformed object tell nothing.
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

const ParameterCard& CardOf(const ModelParameter& parameter) {
  const auto& [effect, index] = parameter.places.front();
  return effect->Card().parameters[index];
}

// What is known of a parameter before: `mean`, the start unless it is given, and `deviation`; of
// one on a logarithmic scale a small one, or the scale's part of it.
void ReadPrior(const Config& item, const ParameterCard& card, CalibratedParameter* prior) {
  if (!item.Has("deviation")) {
    if (item.Has("mean")) item.Fail("mean", "needs a `deviation` beside it");
    return;
  }
  prior->prior_mean = item.Quantity("mean", card.dimension, card.bounds, prior->start);
  if (prior->log_scale && !(prior->prior_mean > 0))
    item.Fail("mean", "must be positive: the parameter is fitted on a logarithmic scale");
  const double deviation = item.Quantity("deviation", card.dimension, kPositive);
  prior->prior_deviation = prior->log_scale ? deviation / prior->prior_mean : deviation;
}

// `fit: {parameters: [{name: young_modulus, min: 1 kPa}, …]}`; absent: the material's.
std::vector<ModelParameter> ReadFitted(const Config& config,
                                       const std::vector<std::shared_ptr<Effect>>& effects) {
  const std::vector<ModelParameter> known = ModelParameters(effects);
  const auto fit = config.OptionalChild("fit");
  if (!fit) {
    std::vector<ModelParameter> of_material;
    for (const ModelParameter& parameter : known)
      if (parameter.places.front().first == effects.front()) of_material.push_back(parameter);
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
    const ParameterCard& card = CardOf(parameter);
    prior.min = item.Quantity("min", card.dimension, card.bounds, prior.min);
    prior.max = item.Quantity("max", card.dimension, card.bounds, prior.max);
    if (prior.min > prior.max) item.Fail("min", "is above max");
    if (!(prior.min <= prior.start && prior.start <= prior.max))
      item.Fail("name", fmt::format("starts at {:g} {}, outside {:g} to {:g}", prior.start,
                                    parameter.unit, prior.min, prior.max));
    ReadPrior(item, card, &prior);
    fitted.push_back(parameter);
  }
  return fitted;
}

}  // namespace

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

namespace {

constexpr double kLongestStep = 0.005;  // s, to begin with
constexpr double kMostSteps = 1e6;

// Mean distance of the frames that are used, s, of the recording where it is least.
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

// What the fit begins with. Steps of quasi-static motions end at the frames in any case.
double FirstStep(const PredictionStudy& study) {
  const double spacing = ShortestSpacing(study.recordings);
  if (study.scheme != TimeScheme::kQuasiStatic) return std::min(kLongestStep, 0.5 * spacing);
  return std::isfinite(spacing) ? spacing : kLongestStep;
}

// A step of the order of the recording follows no motion, and with millions of them a fit would not
// end.
void RequireSoundStep(const Config& motion, const PredictionStudy& study) {
  constexpr double kFewest = 10;
  const double duration = Duration(study), steps = duration / study.time_step;
  const double fewest = study.scheme == TimeScheme::kQuasiStatic ? 0 : kFewest;
  if (steps < fewest || steps > kMostSteps)
    motion.Fail("time_step",
                fmt::format("makes {:.3g} steps of the {:g} s that are predicted; {:g} to {:g} are "
                            "sound",
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
  study.name = config.Text("name");
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
  study.place_deviation =
      config.Quantity("place_deviation", kLength, kNotNegative, study.place_deviation);
  study.scan = ReadScanSettings(config);
  for (const Config& item : config.Items("recordings")) {
    PredictedRecording recording =
        ReadRecordingEntry(item, study.effects.front().get(), study.scan, study.scheme,
                           /*tells_the_shape=*/study.recordings.empty());
    for (const PredictedRecording& other : study.recordings)
      if (other.name == recording.name)
        item.Fail("name", fmt::format("\"{}\" is that of another recording already; without one, "
                                      "an entry has its recording's",
                                      recording.name));
    study.recordings.push_back(std::move(recording));
  }
  if (study.recordings.empty()) config.Fail("recordings", "is empty");
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
        fmt::format("last {:g} s, which a motion with inertia takes millions of steps for: give "
                    "`motion: {{scheme: quasi_static}}`, a shorter `to`, or a time_step",
                    Duration(study)));
  const auto& density = study.recordings.front().recording.object.density;
  study.density = density ? config.Quantity("density", kDensity, kPositive, *density)
                          : config.Quantity("density", kDensity, kPositive);
  study.fitted = ReadFitted(config, study.effects);
  config.RefuseUnknownKeys();
  study.configuration = config.Resolved();
  return study;
}

}  // namespace lacuna
