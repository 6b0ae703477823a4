#include "reconstruction/shown_reconstruction.h"

#include <glog/logging.h>

#include <iterator>
#include <utility>

#include "effects/gravity.h"
#include "geometry/thinned_surface.h"
#include "reconstruction/recorded_states.h"
#include "reconstruction/residual_at_vertices.h"
#include "record/thinning_notes.h"

namespace lacuna {
namespace {

std::vector<size_t> UsableFrames(const FollowedMotion& motion) {
  std::vector<size_t> usable;
  for (size_t k = 0; k < motion.frames.size(); ++k)
    if (motion.frames[k].solver.usable) usable.push_back(k);
  return usable;
}

}  // namespace

MotionRecord ShownReconstruction(const ReconstructionStudy& study,
                                 const std::vector<FrameState>& states,
                                 const FollowedMotion& motion) {
  const Body& body = *motion.body;
  const std::vector<size_t> usable = UsableFrames(motion);
  CHECK(!usable.empty());
  MotionRecord shown;
  shown.recording = study.recording.name;
  if (const auto gravity = GravityOf(study.effects); gravity && gravity->norm() > 0)
    shown.up = -gravity->normalized();
  const ThinnedSurface thinned = ThinSurface(body.boundary.surface, kMostShownVertices);
  shown.triangles = thinned.triangles;
  std::vector<int> nodes;
  for (const int vertex : thinned.kept) nodes.push_back(body.boundary.node[vertex]);

  const std::vector<int> chosen = EvenlySpread(static_cast<int>(usable.size()), kMostShownFrames);
  const auto vertices = static_cast<Eigen::Index>(nodes.size());
  const auto count = static_cast<Eigen::Index>(chosen.size());
  shown.times.resize(count);
  shown.positions.resize(3 * vertices, count);
  ShownField residual{"residual",
                      HasIdentifiedPoints(study, states)
                          ? "distance from the nearest tracked point's place"
                          : "distance from the registered scan",
                      "m", Eigen::MatrixXd(vertices, count)};
  const ResidualAtVertices residuals(study, states, motion);
  shown.fields = {
      {"displacement", "displacement", "m", Eigen::MatrixXd(vertices, count)},
      {"force",
       study.follow.forces.AreFitted() ? "fitted force at a node" : "recorded force at a node", "N",
       Eigen::MatrixXd(vertices, count)}};
  for (Eigen::Index f = 0; f < count; ++f) {
    const size_t k = usable[static_cast<size_t>(chosen[static_cast<size_t>(f)])];
    const FollowedFrame& frame = motion.frames[k];
    const auto lengths = [](const Eigen::Matrix3Xd& vectors, const std::vector<int>& at) {
      return Eigen::VectorXd(vectors(Eigen::all, at).colwise().norm().transpose());
    };
    shown.times[f] = frame.time;
    shown.positions.col(f) = Eigen::Matrix3Xd(frame.position(Eigen::all, nodes)).reshaped();
    residual.values.col(f) = lengths(residuals.Of(frame), thinned.kept);
    shown.fields[0].values.col(f) = lengths(frame.position - body.mesh.nodes, nodes);
    shown.fields[1].values.col(f) = lengths(frame.force, nodes);
    shown.scans.push_back(states[k].cloud.points);
  }
  // A report lists the fields in this order.
  if (!residual.values.array().isNaN().all())
    shown.fields.insert(shown.fields.begin(), std::move(residual));
  shown.notes = NotesOnThinning(vertices, body.boundary.surface.vertices.cols(), count,
                                std::ssize(motion.frames));
  return shown;
}

}  // namespace lacuna
