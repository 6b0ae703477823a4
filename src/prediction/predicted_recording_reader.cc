#include "prediction/predicted_recording_reader.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <limits>
#include <optional>

#include "analysis/residual_statistics.h"
#include "core/quantity.h"
#include "experiment/model_reader.h"
#include "experiment/tracked_points.h"

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
  if (config.Has("force")) hold.force = config.Vector("force", kForce);
  return hold;
}

// Requires that the object is held in the first of the frames that are used, and not after the
// last.
void RequireReleaseWithinFrames(const Config& config, const PredictedRecording& item) {
  const double first = item.recording.times[item.frames.front()];
  const double last = item.recording.times[item.frames.back()];
  if (item.hold->release > last)
    config.Fail("release", fmt::format("lies after the last frame that is used, at {}: the "
                                       "object is never released",
                                       TimeText(last)));
  if (item.hold->release < first)
    config.Fail("release", fmt::format("lies before the first frame that is used, at {}: no "
                                       "frame shows the object while it is held",
                                       TimeText(first)));
}

// The largest displacement, m, of a marker that is seen in both frames.
double LargestMove(const Eigen::Matrix3Xd& from, const Eigen::Matrix3Xd& to) {
  double largest = 0;
  for (Eigen::Index m = 0; m < from.cols(); ++m) {
    const double move = (to.col(m) - from.col(m)).norm();
    if (move > largest) largest = move;
  }
  return largest;
}

// Without a hold the first frame must be an equilibrium. The object is taken to move already where
// its displacement between the first two frames is a large part of its whole motion, and well above
// the smallest displacement between any two frames, which shows the noise.
void RequireStartAtRest(const Config& config, const PredictedRecording& item) {
  constexpr double kLarge = 0.25, kBeyondNoise = 3;
  const Recording& recording = item.recording;
  if (item.hold || item.ShowsScans() || item.frames.size() < 3) return;
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
                "the object already moves between its first two frames; a prediction starts from "
                "rest: give `from:` or `hold:`");
}

// Requires the place of each marker on the undeformed object.
void RequirePlaces(const Config& config, const Recording& recording) {
  std::vector<std::string> placed, missing;
  for (Eigen::Index m = 0; m < recording.markers.places.cols(); ++m)
    (recording.markers.places.col(m).allFinite() ? placed : missing)
        .push_back(recording.markers.names[static_cast<size_t>(m)]);
  if (missing.empty()) return;
  const std::string other =
      placed.empty() ? ""
                     : fmt::format(", or `markers: [{}]` under `frames`, which leaves out the rest",
                                   fmt::join(placed, ", "));
  config.Fail("recording",
              fmt::format("the place of {} on the undeformed object is not known: {} needs "
                          "`marker_places` (or `marker_places_file`) for {}{}",
                          fmt::join(missing, ", "), recording.file.string(),
                          missing.size() == 1 ? "it" : "them", other));
}

// Checks that the recording contains what a prediction of markers or of scans needs.
void CheckObserved(const Config& config, const PredictedRecording& item, bool defines_body_shape) {
  const Recording& recording = item.recording;
  const bool of_first_frame = recording.reference.source == ReferenceSource::kFirstFrame;
  const bool is_tracked = HasTrackedPoints(recording);
  if (is_tracked && item.hold)
    config.Fail(
        "hold",
        "the places of tracked points are taken from the first frame, so the object may not "
        "be held in a deformed shape there");
  if (!item.ShowsScans()) {
    RequirePlaces(config, recording);
    if (of_first_frame && !is_tracked)
      config.Fail("recording", "has no reference shape: markers alone do not determine it");
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
      config.Fail("recording", fmt::format("{} is to deform with the scan, whose points are not "
                                           "identified: this needs markers or tracked points",
                                           grip.region.name));
  if (defines_body_shape && of_first_frame && item.hold) {
    config.Fail("hold",
                "the recording's reference shape is its first frame, in which the object is held "
                "in a deformed shape: give a `reference` mesh");
  }
}

// Requires that the given paths and forces cover the frames that are used.
void RequireCoveredFrames(const Config& config, const PredictedRecording& item) {
  const int first = item.frames.front(), last = item.frames.back();
  for (const std::string& problem : {DescribeUncoveredPath(item.recording, first, last),
                                     DescribeUncoveredForce(item.recording, first, last)})
    if (!problem.empty()) config.Fail("recording", problem);
}

// Estimates the noise of readings that do not say it, and requires that each covers a frame.
void CheckReactions(const Config& config, PredictedRecording* item) {
  const std::vector<double>& times = item->recording.times;
  for (MeasuredReaction& reaction : item->recording.object.reactions) {
    if (std::none_of(item->frames.begin(), item->frames.end(),
                     [&](int frame) { return reaction.Covers(times[frame]); }))
      config.Fail("recording", fmt::format("{} covers {:.9g} s to {:.9g} s, in which no frame lies",
                                           reaction.file.string(), reaction.times[0],
                                           reaction.times[reaction.times.size() - 1]));
    if (reaction.deviation > 0) continue;
    reaction.deviation = WhiteNoise(reaction.values);
    reaction.deviation_is_estimated = true;
    if (!(reaction.deviation > 0))
      config.Fail("recording",
                  fmt::format("measured_{} of {}: deviation: cannot be estimated from {} (few "
                              "values, or the same in most rows); give it",
                              reaction.Quantity(), reaction.name, reaction.file.string()));
  }
}

}  // namespace

PredictedRecording ReadRecordingEntry(const Config& config, const EffectList& of_study,
                                      const ScanSettings& scan, TimeScheme scheme,
                                      bool defines_body_shape) {
  PredictedRecording item;
  item.recording = LoadRecording(config, "recording");
  item.name = config.Text("name", item.recording.name);
  if (IsScan(item.recording)) item.scans = std::make_shared<const ScanFrames>(item.recording, scan);
  const double from = config.Quantity("from", kTime, kAnyValue, item.recording.times.front());
  const double to = config.Quantity("to", kTime, kAnyValue, item.recording.times.back());
  item.frames = FramesWithin(item.recording, from, to, config.Integer("every", 1, 1000000, 1));
  item.fitted = config.Flag("fitted", true);
  item.fit_until = config.Quantity("fit_until", kTime, kAnyValue, kForever);
  item.clock_deviation = config.Quantity("clock_deviation", kTime, kNotNegative, 0);
  if (const auto registration = config.OptionalChild("registration")) {
    item.shift_deviation = registration->Quantity("shift_deviation", kLength, kPositive);
    item.turn_deviation = registration->Quantity("turn_deviation", kAngle, kPositive);
  }
  const std::optional<Config> hold = config.OptionalChild("hold");
  if (hold) {
    item.hold = ReadHold(*hold, item.recording);
    AddFileOf(item.hold->region, &item.recording);
  }
  item.simulated_cells = ReadSimulatedCells(config, item.recording.object.reactions);
  item.effects = ReadEffectsBeside(of_study, config);

  // One equilibrium can be fitted; a motion needs two steps.
  const size_t fewest = scheme == TimeScheme::kQuasiStatic ? 1 : 3;
  if (item.frames.size() < fewest) {
    config.Fail("recording", fmt::format("{} frames lie between {} and {}; at least {} are needed",
                                         item.frames.size(), TimeText(from), TimeText(to), fewest));
  }
  if (hold) RequireReleaseWithinFrames(*hold, item);
  if (item.fitted && item.fit_until < item.recording.times[item.frames[fewest - 1]])
    config.Fail("fit_until", fmt::format("leaves fewer than {} frames to fit", fewest));
  if (HasTrackedPoints(item.recording)) ConvertTrackedPointsToMarkers(item.frames, &item.recording);
  CheckObserved(config, item, defines_body_shape);
  if (scheme == TimeScheme::kQuasiStatic) {
    if (item.hold)
      config.Fail("hold", "a released object vibrates, so motion.scheme may not be quasi_static");
  } else {
    RequireStartAtRest(config, item);
  }
  CheckReactions(config, &item);
  for (const MeasuredForce& force : item.recording.object.forces)
    if (!force.region)
      config.Fail("recording", "does not say where " + force.name + " acts (its region)");
  RequireCoveredFrames(config, item);
  return item;
}

}  // namespace lacuna
