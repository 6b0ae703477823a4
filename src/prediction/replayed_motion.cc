#include "prediction/replayed_motion.h"

#include <algorithm>
#include <vector>

#include "effects/gravity.h"
#include "fem/effect_memory.h"
#include "fem/element_strain.h"
#include "geometry/embedding.h"
#include "prediction/compared_frame.h"

namespace lacuna {
namespace {

void FindUp(const Model& model, ReplayedMotion* motion) {
  const Eigen::Vector3d gravity = GravityOf(model.effects).value_or(Eigen::Vector3d::Zero());
  if (gravity.norm() == 0) return;
  motion->up = -gravity.normalized();
  motion->up_from_gravity = true;
}

// The points of a recording as material points of its model.
class EmbeddedPoints {
 public:
  // The recording's model must outlive this.
  explicit EmbeddedPoints(const RecordingModel& recording)
      : recording_(recording),
        places_(recording.Markers() != nullptr ? recording.Markers()->places_in_mesh()
                                               : Embed(Mesh(), recording.observer().Places())) {}

  // The element that contains a point.
  int ElementOf(Eigen::Index point) const { return places_.tet[point]; }
  // The positions of the points for those of the nodes (3n).
  Eigen::Matrix3Xd PlacesAt(const Eigen::VectorXd& nodal) const {
    if (recording_.Markers() == nullptr)
      return PointsAt(places_, Mesh(), nodal.reshaped(3, Mesh().NodeCount()));
    const Eigen::VectorXd stacked = recording_.Markers()->rows() * nodal;
    return stacked.reshaped(3, recording_.PointCount());
  }

 private:
  const TetMesh& Mesh() const { return recording_.model().body->mesh; }

  const RecordingModel& recording_;
  Embedding places_;
};

// Stores the motion of the points in one frame. Frames must be stored in order.
void StorePoints(const RecordingModel& recording, const EmbeddedPoints& points,
                 const PredictedState& state, int frame, ReplayedMotion* motion) {
  motion->predicted.col(frame) =
      (motion->registration * points.PlacesAt(state.position)).reshaped();
  const Body& body = *recording.model().body;
  for (Eigen::Index m = 0; m < recording.PointCount(); ++m) {
    const ElementStrain strain =
        MeanStrain(body, points.ElementOf(m), state.position, state.velocity);
    motion->strain(m, frame) = LargestPrincipal(strain.strain);
    motion->strain_rate(m, frame) = LargestPrincipal(strain.rate);
    motion->height(m, frame) = motion->up.dot(motion->predicted.col(frame).segment<3>(3 * m));
  }
}

// Compares one frame with what was measured in it. Frames must be compared in order.
void CompareFrame(const RecordingModel& recording, const PredictedState& state, int frame,
                  bool moves, ReplayedMotion* motion) {
  std::vector<MisfitDirection> directions;
  for (const RecordingModel::Nuisance& nuisance : recording.nuisances())
    directions.push_back(nuisance.direction);
  const Eigen::Index simulated =
      std::count_if(directions.begin(), directions.end(),
                    [](const MisfitDirection& direction) { return direction.IsSimulated(); });
  NodalMotion nodal{state.position, state.velocity,
                    Eigen::MatrixXd::Zero(state.position.size(), simulated), moves};
  nodal.Register(motion->registration);
  const int number = recording.recording().frames[static_cast<size_t>(frame)];
  AppendFrame(recording, directions, motion->registration, number, nodal,
              recording.observer().Observe(number, nodal.position), &motion->misfit);
}

}  // namespace

ReplayedMotion Replay(const RecordingModel& recording, const Eigen::VectorXd& nuisance,
                      const EffectList& further) {
  ReplayedMotion motion;
  const Model& model = recording.model();
  Model loaded = recording.PlacedModel(nuisance);
  loaded.effects.insert(loaded.effects.end(), further.begin(), further.end());
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

  const Eigen::Index points = recording.PointCount();
  const Eigen::Index count = static_cast<Eigen::Index>(frames.size());
  motion.predicted.resize(3 * points, count);
  motion.strain.resize(points, count);
  motion.strain_rate.resize(points, count);
  motion.height.resize(points, count);
  motion.misfit = EmptyMisfit(recording, frames.size(), recording.nuisances().size());
  const EmbeddedPoints points_in_mesh(recording);
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
    StorePoints(recording, points_in_mesh, state, frame, &motion);
    CompareFrame(recording, state, frame, state.time > options.start_time, &motion);
    if (index < at_start) return;
    const auto& effect_state =
        memory.Advance(state.position, state.velocity, state.time, state.time - time_before);
    time_before = state.time;
    if ((last - frame) % stride == 0) keep(frame, effect_state);
  });
  return motion;
}

}  // namespace lacuna
