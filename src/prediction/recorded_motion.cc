#include "prediction/recorded_motion.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/first_few.h"
#include "core/quantity.h"
#include "experiment/model_reader.h"
#include "prediction/driven_motion.h"
#include "prediction/place_doubts.h"
#include "prediction/recording_noise.h"

namespace lacuna {
namespace {

// A coordinate moves where its scatter exceeds this many standard deviations of the white noise.
// The largest scatter of a hundred coordinates at rest is below 1.5, and somewhat larger if the
// noise is correlated from frame to frame.
constexpr double kMoves = 2;

// Mean and standard deviation of one coordinate over the frames that show it.
struct Spread {
  double mean = 0, deviation = 0;
};
Spread SpreadOf(const PredictedRecording& item, const std::vector<int>& frames, Eigen::Index axis,
                Eigen::Index marker) {
  double sum = 0, squares = 0, seen = 0;
  for (const int frame : frames) {
    const double value = item.recording.markers.positions[frame](axis, marker) -
                         item.recording.markers.places(axis, marker);
    if (std::isnan(value)) continue;
    sum += value;
    squares += value * value;
    ++seen;
  }
  if (seen == 0) return {};
  const double mean = sum / seen;
  return {mean, std::sqrt(std::max(0.0, squares / seen - mean * mean))};
}

// Whether the markers stay in place within their noise over the fitted frames.
bool IsAtRest(const PredictedRecording& item) {
  if (item.ShowsScans()) return false;
  const std::vector<int> frames = item.FittedFrames();
  // Without noise, rounding of the mean square must not be mistaken for motion.
  constexpr double kRounding = 1e-9;  // m
  const double least = kMoves * EstimateRecordingNoise(item, frames) + kRounding;
  for (Eigen::Index marker = 0; marker < item.recording.markers.places.cols(); ++marker)
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      if (SpreadOf(item, frames, axis, marker).deviation > least) return false;
  return true;
}

}  // namespace

bool IsAtRest(const PredictionStudy& study) {
  return std::all_of(study.recordings.begin(), study.recordings.end(),
                     [](const PredictedRecording& item) { return !item.fitted || IsAtRest(item); });
}

std::string RestWarning(const PredictionStudy& study) {
  // Quasi-static frames show none of these in any case, and their jumps, as from load to load, look
  // like noise.
  if (study.scheme == TimeScheme::kQuasiStatic || !IsAtRest(study)) return "";
  const bool is_one_frame = std::all_of(study.recordings.begin(), study.recordings.end(),
                                        [](const PredictedRecording& item) {
                                          return !item.fitted || item.FittedFrames().size() == 1;
                                        });
  return fmt::format(
      "{} stiffness and constant loads, but not mass, damping, drag or anything else that needs "
      "motion",
      is_one_frame ? "a single frame of each recording is fitted: it determines"
                   : "nothing moves in the frames that are fitted: they determine");
}

namespace {

std::string SlownessWarning(const PredictedRecording& item, const PredictionStudy& study) {
  constexpr double kMany = 50;  // time steps per frame
  const std::vector<double>& times = item.recording.times;
  const double steps = (times[item.frames.back()] - times[item.frames.front()]) / study.time_step;
  if (study.scheme == TimeScheme::kQuasiStatic ||
      steps <= kMany * static_cast<double>(item.frames.size()))
    return "";
  return fmt::format(
      "{}: takes {:.0f} steps of {} for {} frames: if the object is in equilibrium in every "
      "frame, `motion: {{scheme: quasi_static}}` takes one step for each",
      item.name, steps, DurationText(study.time_step), item.frames.size());
}

// The model of a recording has the effects of the study and its own.
std::string GravityWarning(const PredictedRecording& item, const PredictionStudy& study) {
  EffectList effects = study.effects;
  effects.insert(effects.end(), item.effects.begin(), item.effects.end());
  const std::string warning = GravityWarning(item.recording.object, effects);
  return warning.empty() ? "" : item.name + ": " + warning;
}

// An effect of the study is reported once. Those of a recording follow the study's, whose material
// determines what is plausible.
std::vector<std::string> ImplausibleValues(const PredictionStudy& study) {
  std::vector<std::string> warnings = ImplausibleParameters(study.effects, ScaleOf(study));
  const auto of_study = static_cast<std::ptrdiff_t>(warnings.size());
  for (const PredictedRecording& item : study.recordings) {
    EffectList effects = study.effects;
    effects.insert(effects.end(), item.effects.begin(), item.effects.end());
    const std::vector<std::string> all = ImplausibleParameters(effects, ScaleOf(study));
    std::transform(all.begin() + of_study, all.end(), std::back_inserter(warnings),
                   [&](const std::string& warning) { return item.name + ": " + warning; });
  }
  return warnings;
}

// A part that has left its undeformed place by the first used frame, although that frame is to show
// the object undeformed.
std::string EarlyPathWarning(const PredictedRecording& item) {
  // Less than this share of the range of the path, or than the noise of a logged pose, is no
  // motion.
  constexpr double kShare = 0.01, kLeastShift = 1e-4 /* m */, kLeastTurn = 2e-3 /* rad */;
  const Recording& recording = item.recording;
  if (recording.reference.source != ReferenceSource::kFirstFrame && !HasTrackedPoints(recording))
    return "";
  for (const RecordedGrip& grip : recording.object.grips) {
    if (grip.motion != GripMotion::kGiven) continue;
    const double first = recording.times[item.frames.front()];
    const Eigen::Isometry3d motion = MotionAt(grip, first);
    const PathRange range = RangeOfPath(grip);
    Eigen::Vector3d displacement = motion * grip.pivot - grip.pivot;
    for (int axis = 0; axis < 3; ++axis)
      if (!grip.axes.Has(axis)) displacement[axis] = 0;
    const double shift = displacement.norm();
    const double turn = grip.axes.IsAll() ? Eigen::AngleAxisd(motion.linear()).angle() : 0;
    if (shift <= std::max(kShare * range.shift, kLeastShift) &&
        turn <= std::max(kShare * range.turn, kLeastTurn))
      continue;
    return fmt::format(
        "{}: the first frame that is used, at {}, is to show the object undeformed, but \"{}\" has "
        "moved by {:.3g} mm and {:.3g}° by then: in a prediction its motion counts from the first "
        "row of its path, {}; let the file begin with a row at the time of that frame",
        item.name, TimeText(first), grip.region.name, 1e3 * shift, turn * 180 / std::numbers::pi,
        grip.file.string());
  }
  return "";
}

std::string UnseenWarning(const PredictedRecording& item) {
  if (item.ShowsScans()) return "";
  const auto is_unseen = [&](int frame) {
    const Eigen::Matrix3Xd& here = item.recording.markers.positions[frame];
    return (here.array().isNaN().colwise().any()).all();
  };
  const auto first = std::find_if(item.frames.begin(), item.frames.end(), is_unseen);
  if (first == item.frames.end()) return "";
  return fmt::format(
      "{}: {} of {} frames show no marker, the first is frame {}; they are not compared", item.name,
      std::count_if(first, item.frames.end(), is_unseen), item.frames.size(), *first);
}

std::string FitUntilWarning(const PredictedRecording& item) {
  const double last = item.recording.times[item.frames.back()];
  if (!item.fitted || !std::isfinite(item.fit_until) || item.fit_until < last) return "";
  return fmt::format(
      "{}: `fit_until: {}` does not lie before the last frame that is used, at {}: all "
      "frames are fitted, and none is held out",
      item.name, TimeText(item.fit_until), TimeText(last));
}

std::string ScanSettingsWarning(const PredictionStudy& study) {
  const bool has_scans =
      std::any_of(study.recordings.begin(), study.recordings.end(),
                  [](const PredictedRecording& item) { return item.ShowsScans(); });
  if (has_scans || !study.configuration.contains("scan")) return "";
  return "`scan` has no effect: no recording is a scan. The noise of markers and tracked points is "
         "`noise`";
}

}  // namespace

// An effect of the study is reported once, and not for each recording.
std::vector<std::string> AuxeticWarnings(const PredictionStudy& study) {
  std::vector<std::string> warnings;
  if (const std::string warning = AuxeticWarning(study.effects); !warning.empty())
    warnings.push_back(warning);
  for (const PredictedRecording& item : study.recordings)
    if (const std::string warning = AuxeticWarning(item.effects); !warning.empty())
      warnings.push_back(item.name + ": " + warning);
  return warnings;
}

std::vector<std::string> StudyWarnings(const PredictionStudy& study) {
  std::vector<std::string> warnings;
  const auto add = [&](const std::string& warning) {
    if (!warning.empty()) warnings.push_back(warning);
  };
  for (const PredictedRecording& item : study.recordings) {
    for (const std::string& warning : item.recording.warnings) add(item.name + ": " + warning);
    add(UnseenWarning(item));
    add(DoubtOfPlaces(study, item));
    add(DoubtOfIncrements(item));
    add(DoubtOfPaths(study, item));
    add(EarlyPathWarning(item));
    add(FitUntilWarning(item));
    add(SlownessWarning(item, study));
    add(GravityWarning(item, study));
  }
  add(ScanSettingsWarning(study));
  for (const std::string& warning : ImplausibleValues(study)) add(warning);
  for (const std::string& warning : AuxeticWarnings(study)) add(warning);
  add(RestWarning(study));
  return warnings;
}

double RestDeformation(const PredictedRecording& item) {
  const std::vector<int> frames = item.FittedFrames();
  double largest = 0;
  for (Eigen::Index marker = 0; marker < item.recording.markers.places.cols(); ++marker) {
    Eigen::Vector3d mean;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      mean[axis] = SpreadOf(item, frames, axis, marker).mean;
    largest = std::max(largest, mean.norm());
  }
  return largest;
}

}  // namespace lacuna
