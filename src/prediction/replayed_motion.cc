#include "prediction/replayed_motion.h"

#include <glog/logging.h>

#include <algorithm>

#include "effects/gravity.h"
#include "fem/effect_memory.h"
#include "fem/element_strain.h"

namespace lacuna {
namespace {

void FindUp(const Model& model, ReplayedMotion* motion) {
  const Eigen::Vector3d gravity = GravityOf(model.effects).value_or(Eigen::Vector3d::Zero());
  if (gravity.norm() == 0) return;
  motion->up = -gravity.normalized();
  motion->up_from_gravity = true;
}

// Stores the motion and deformation of the markers in one frame. Frames must be stored in order.
void StoreMarkers(const RecordingModel& recording, const PredictedState& state, int frame,
                  ReplayedMotion* motion) {
  const MarkerObserver& observer = *recording.Markers();
  const Embedding& places = observer.places_in_mesh();
  const Eigen::Index markers = recording.PointCount();
  const auto vectors = [&](const Eigen::VectorXd& nodal) {
    const Eigen::VectorXd stacked = observer.rows() * nodal;
    return Eigen::Matrix3Xd(stacked.reshaped(3, markers));
  };
  motion->predicted.col(frame) = (motion->registration * vectors(state.position)).reshaped();
  motion->velocity.col(frame) =
      (motion->registration.linear() * vectors(state.velocity)).reshaped();
  for (const Eigen::Matrix3d& deformation : observer.DeformationAt(state.position))
    motion->deformation.emplace_back(motion->registration.linear() * deformation);
  const Body& body = *recording.model().body;
  for (Eigen::Index m = 0; m < markers; ++m) {
    const ElementStrain strain = MeanStrain(body, places.tet[m], state.position, state.velocity);
    motion->strain(m, frame) = LargestPrincipal(strain.strain);
    motion->strain_rate(m, frame) = LargestPrincipal(strain.rate);
    motion->height(m, frame) = motion->up.dot(motion->predicted.col(frame).segment<3>(3 * m));
  }
}

}  // namespace

ReplayedMotion Replay(const RecordingModel& recording, const Eigen::VectorXd& nuisance,
                      const EffectList& further) {
  ReplayedMotion motion;
  const Model& model = recording.model();
  Model loaded = recording.PlacedModel(nuisance);
  loaded.effects.insert(loaded.effects.end(), further.begin(), further.end());
  CHECK(!recording.recording().ShowsScans()) << "only markers are replayed";
  const std::vector<int>& frames = recording.recording().frames;
  const PredictionOptions options = recording.Options(nuisance);
  motion.nuisance = nuisance;
  motion.delay = recording.Delay(nuisance);
  motion.registration = recording.Registration(nuisance);
  FindUp(model, &motion);

  // The start of the motion is visited too; it comes after the frames at rest.
  std::vector<double> times;
  for (const int frame : frames)
    times.push_back(recording.recording().recording.times[frame] - motion.delay);
  const auto start = std::upper_bound(times.begin(), times.end(), options.start_time);
  const int at_start = static_cast<int>(start - times.begin());
  times.insert(start, options.start_time);

  const Eigen::Index markers = recording.PointCount();
  const Eigen::Index count = static_cast<Eigen::Index>(frames.size());
  motion.predicted.resize(3 * markers, count);
  motion.velocity.resize(3 * markers, count);
  motion.strain.resize(markers, count);
  motion.strain_rate.resize(markers, count);
  motion.height.resize(markers, count);
  const int last = static_cast<int>(count) - 1;
  const int stride = std::max(1, (last - at_start) / (ReplayedMotion::kMostStates - 2) + 1);
  EffectMemory memory(model, options.step.scheme);
  double time_before = options.start_time;
  motion.summary = Predict(loaded, options, times, {}, [&](int index, const PredictedState& state) {
    const auto keep = [&](int frame, const std::vector<Eigen::VectorXd>& effect_state) {
      motion.states.push_back({state.time, state.position, state.velocity, effect_state});
      motion.state_frame.push_back(frame);
    };
    if (index == at_start) {
      keep(at_start - 1, memory.Advance(state.position, state.velocity, state.time, 0));
      return;
    }
    const int frame = index < at_start ? index : index - 1;
    StoreMarkers(recording, state, frame, &motion);
    if (index < at_start) return;
    const auto& effect_state =
        memory.Advance(state.position, state.velocity, state.time, state.time - time_before);
    time_before = state.time;
    if ((last - frame) % stride == 0) keep(frame, effect_state);
  });
  return motion;
}

}  // namespace lacuna
