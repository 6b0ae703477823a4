#include "prediction/predicted_states.h"

#include <algorithm>
#include <iterator>
#include <vector>

#include "effects/gravity.h"
#include "fem/effect_memory.h"
#include "fem/element_strain.h"
#include "fem/nodal_recovery.h"
#include "geometry/thinned_surface.h"
#include "record/thinning_notes.h"

namespace lacuna {
namespace {

// The nodes' mean of the largest principal strains of the elements around them, by volume.
Eigen::VectorXd NodalStrain(const Body& body, const TrajectoryState& state) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(body.NodeCount()), volume = sum;
  for (int element = 0; element < body.ElementCount(); ++element) {
    const double strain =
        LargestPrincipal(MeanStrain(body, element, state.position, state.velocity).strain);
    const double share =
        body.weight.segment(element * body.points_per_element, body.points_per_element).sum();
    for (const int node : body.mesh.tets.col(element)) {
      sum[node] += share * strain;
      volume[node] += share;
    }
  }
  return sum.cwiseQuotient(volume);
}

// The entries of nodal values at the vertices that are shown.
Eigen::VectorXd At(const Eigen::VectorXd& nodal, const std::vector<int>& nodes) {
  return nodal(nodes);
}

Eigen::VectorXd LengthsAt(const Eigen::Matrix3Xd& nodal, const std::vector<int>& nodes) {
  return At(nodal.colwise().norm().transpose(), nodes);
}

}  // namespace

PredictedStates PredictStates(const RecordingModel& recording, const Eigen::VectorXd& nuisance,
                              int most) {
  PredictedStates predicted;
  predicted.delay = recording.Delay(nuisance);
  predicted.registration = recording.Registration(nuisance);
  const std::vector<int>& frames = recording.recording().frames;
  const PredictionOptions options = recording.Options(nuisance);
  EffectMemory memory(recording.model(), options.step.scheme);
  const std::vector<int> chosen = EvenlySpread(static_cast<int>(frames.size()), most);
  // Internal variables are followed through the start of the motion and all frames; without any,
  // the frames in between need not be visited.
  std::vector<double> times;
  std::vector<char> is_kept;
  for (int frame = 0; frame < static_cast<int>(frames.size()); ++frame) {
    const bool keep = std::binary_search(chosen.begin(), chosen.end(), frame);
    if (!keep && memory.IsEmpty()) continue;
    times.push_back(recording.recording().recording.times[frames[static_cast<size_t>(frame)]] -
                    predicted.delay);
    is_kept.push_back(keep);
  }
  if (!memory.IsEmpty()) {
    const auto start = std::upper_bound(times.begin(), times.end(), options.start_time);
    is_kept.insert(is_kept.begin() + (start - times.begin()), 0);
    times.insert(start, options.start_time);
  }
  double time_before = options.start_time;
  const Model placed = recording.PlacedModel(nuisance);
  predicted.summary =
      Predict(placed, options, times, {}, [&](int index, const PredictedState& state) {
        const std::vector<Eigen::VectorXd>& effect_state = memory.Advance(
            state.position, state.velocity, state.time, std::max(state.time - time_before, 0.0));
        time_before = std::max(state.time, time_before);
        if (is_kept[static_cast<size_t>(index)])
          predicted.states.push_back({state.time, state.position, state.velocity, effect_state});
      });
  return predicted;
}

MotionRecord ShownMotion(const RecordingModel& recording, const PredictedStates& predicted,
                         const SmoothForce* force) {
  const Body& body = *recording.model().body;
  MotionRecord motion;
  motion.recording = recording.recording().name;
  if (const auto gravity = GravityOf(recording.model().effects); gravity && gravity->norm() > 0)
    motion.up = predicted.registration.linear() * -gravity->normalized();
  const ThinnedSurface shown = ThinSurface(body.boundary.surface, kMostShownVertices);
  motion.triangles = shown.triangles;
  std::vector<int> nodes;
  for (const int vertex : shown.kept) nodes.push_back(body.boundary.node[vertex]);

  const Eigen::Index count = static_cast<Eigen::Index>(predicted.states.size());
  const Eigen::Index vertices = static_cast<Eigen::Index>(nodes.size());
  motion.times.resize(count);
  motion.positions.resize(3 * vertices, count);
  motion.fields = {{"displacement", "displacement", "m", Eigen::MatrixXd(vertices, count)},
                   {"speed", "speed", "m/s", Eigen::MatrixXd(vertices, count)},
                   {"strain", "largest principal strain", "", Eigen::MatrixXd(vertices, count)},
                   {"von_mises", "von Mises stress", "Pa", Eigen::MatrixXd(vertices, count)},
                   {"stretch", "largest principal stretch", "", Eigen::MatrixXd(vertices, count)}};
  if (force != nullptr)
    motion.fields.push_back({"unexplained_force", "unexplained force per volume", "N/m³",
                             Eigen::MatrixXd(vertices, count)});
  for (Eigen::Index k = 0; k < count; ++k) {
    const TrajectoryState& state = predicted.states[static_cast<size_t>(k)];
    const Eigen::Matrix3Xd position = state.position.reshaped(3, body.NodeCount());
    motion.times[k] = state.time + predicted.delay;
    const Eigen::Matrix3Xd surface = predicted.registration * position(Eigen::all, nodes);
    motion.positions.col(k) = surface.reshaped();
    motion.fields[0].values.col(k) = LengthsAt(position - body.mesh.nodes, nodes);
    motion.fields[1].values.col(k) = LengthsAt(state.velocity.reshaped(3, body.NodeCount()), nodes);
    motion.fields[2].values.col(k) = At(NodalStrain(body, state), nodes);
    const NodalStress stress = RecoverNodalStress(recording.model(), state.position, state.velocity,
                                                  state.time, state.effect_state);
    motion.fields[3].values.col(k) = At(stress.von_mises, nodes);
    motion.fields[4].values.col(k) = At(stress.stretch.row(0).transpose(), nodes);
    if (force != nullptr)
      motion.fields[5].values.col(k) = LengthsAt(force->DensityAt(state.time), nodes);
  }
  motion.notes = NotesOnThinning(vertices, body.boundary.surface.vertices.cols(), count,
                                 std::ssize(recording.recording().frames));
  if (!predicted.summary.IsUsable())
    motion.notes.push_back("The prediction stops early: " + predicted.summary.message);
  return motion;
}

}  // namespace lacuna
