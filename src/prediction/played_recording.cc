#include "prediction/played_recording.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <utility>

#include "core/error.h"
#include "core/quantity.h"
#include "prediction/reaction_misfit.h"
#include "prediction/reading_times.h"
#include "scan/normal_noise.h"

namespace lacuna {
namespace {

// The reading of a load cell in the frames, at these times, that it covers and for which the
// prediction got far enough.
MeasuredReaction PlayedReading(const MeasuredReaction& reading, const ReactionMisfit& misfit,
                               const std::vector<double>& times) {
  MeasuredReaction played = reading;
  std::vector<double> covered;
  std::vector<Eigen::VectorXd> forces;
  for (size_t k = 0; k < times.size(); ++k) {
    const Eigen::Index first = static_cast<Eigen::Index>(k) * reading.Components();
    if (first + reading.Components() > misfit.residual.size()) break;
    if (!reading.Covers(times[k])) continue;
    covered.push_back(times[k]);
    forces.emplace_back(misfit.residual.segment(first, reading.Components()) +
                        ReadingAt(reading, times[k]));
  }
  const Eigen::Index count = static_cast<Eigen::Index>(covered.size());
  played.times = Eigen::Map<const Eigen::VectorXd>(covered.data(), count);
  played.values.resize(reading.Components(), count);
  for (Eigen::Index k = 0; k < count; ++k) played.values.col(k) = forces[static_cast<size_t>(k)];
  return played;
}

// For each load cell, the times (s, of the model) of what it shows in the frames: a late cell shows
// what was the case before. Empty for one without a delay.
std::vector<std::vector<double>> CellTimesOf(const std::vector<double>& frame_times,
                                             const RecordingModel& model,
                                             const Eigen::VectorXd& nuisance) {
  const std::vector<SimulatedCell>& cells = model.recording().simulated_cells;
  CHECK(cells.empty() || cells.size() == model.Reactions().size());
  std::vector<std::vector<double>> times(model.Reactions().size());
  for (size_t k = 0; k < times.size(); ++k) {
    double delay = model.CellDelay(k, nuisance);
    if (!cells.empty()) delay += cells[k].delay;
    if (delay != 0) times[k] = Delayed(frame_times, delay);
  }
  return times;
}

}  // namespace

Eigen::VectorXd PlayedNuisances(const RecordingModel& model) {
  const PredictedRecording& item = model.recording();
  if (item.hold && !item.hold->force)
    throw InputError(
        fmt::format("{}: the object is held until {} by a force that is not known; to play the "
                    "recording, give `force` in its `hold`",
                    item.name, TimeText(item.hold->release)));
  Eigen::VectorXd values(static_cast<Eigen::Index>(model.nuisances().size()));
  for (Eigen::Index k = 0; k < values.size(); ++k)
    values[k] = model.nuisances()[static_cast<size_t>(k)].prior.start;
  return values;
}

PlayedRecording Play(const RecordingModel& model, const Eigen::VectorXd& nuisance) {
  const MarkerObserver* observer = model.Markers();
  CHECK(observer != nullptr) << model.recording().name << " shows scans";
  const PredictedRecording& item = model.recording();
  const Model placed = model.PlacedModel(nuisance);
  PredictionOptions options = model.Options(nuisance);
  options.reactions = MeasuredReactions(model.Reactions(), placed);
  const Eigen::Isometry3d registration = model.Registration(nuisance);
  std::vector<double> of_frames;
  for (const int frame : item.frames) of_frames.push_back(item.recording.times[frame]);
  const std::vector<double> of_model = Delayed(of_frames, model.Delay(nuisance));
  const std::vector<ReadingTime> moments =
      ReadingTimesOf(of_model, CellTimesOf(of_model, model, nuisance));
  PlayedRecording played;
  std::vector<ReactionMisfit> reactions(model.Reactions().size());
  played.summary =
      Predict(placed, options, TimesOf(moments), {}, [&](int index, const PredictedState& state) {
        const ReadingTime& moment = moments[static_cast<size_t>(index)];
        for (const size_t k : moment.cells)
          AppendReaction(model.Reactions(), k, of_frames[moment.frame], state, options.start_time,
                         {}, &reactions[k]);
        if (!moment.shows_frame) return;
        const Eigen::Index nodes = state.position.size() / 3;
        played.times.push_back(of_frames[moment.frame]);
        played.positions.emplace_back(state.position.reshaped(3, nodes));
        played.velocities.emplace_back(state.velocity.reshaped(3, nodes));
        const Eigen::VectorXd seen = observer->rows() * state.position;
        const Eigen::Matrix3Xd markers = seen.reshaped(3, model.PointCount());
        played.markers.emplace_back(registration * markers);
      });
  for (size_t k = 0; k < reactions.size(); ++k) {
    const MeasuredReaction& reading = model.Reactions()[k];
    played.reactions.push_back(PlayedReading(reading, reactions[k], of_frames));
    if (item.simulated_cells.empty()) continue;
    played.reactions.back().values.colwise() +=
        reading.directions.transpose() * item.simulated_cells[k].tare;
  }
  return played;
}

MarkerRecording AsRecording(const PredictedRecording& item, const PlayedRecording& played,
                            double noise, uint64_t seed) {
  constexpr uint64_t kMarkerNoise = 90, kForceNoise = 91;  // streams
  MarkerRecording recording;
  recording.name = item.name;
  recording.object = item.recording.object;
  recording.object.reactions = played.reactions;
  recording.times = played.times;
  recording.markers = {item.recording.markers.names, item.recording.markers.places, played.markers};
  recording.instrument = item.recording.instrument;
  for (size_t f = 0; noise > 0 && f < played.markers.size(); ++f)
    AddNormalNoise(noise, {.seed = seed, .stream = kMarkerNoise, .number = f},
                   recording.markers.positions[f]);
  for (size_t r = 0; r < recording.object.reactions.size(); ++r) {
    MeasuredReaction& reading = recording.object.reactions[r];
    AddNormalNoise(reading.deviation, {.seed = seed, .stream = kForceNoise, .number = r},
                   reading.values);
  }
  return recording;
}

}  // namespace lacuna
