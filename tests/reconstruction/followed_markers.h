// Markers on a bar, and a model that follows them.
#ifndef LACUNA_TESTS_RECONSTRUCTION_FOLLOWED_MARKERS_H_
#define LACUNA_TESTS_RECONSTRUCTION_FOLLOWED_MARKERS_H_

#include <fmt/format.h>

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "experiment/frame_states.h"
#include "experiment/reference_body.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_measures.h"
#include "reconstruction/reconstruction_study.h"
#include "reconstruction/recorded_states.h"
#include "support/box_mesh.h"
#include "support/marker_recording.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {

// Markers on the upper side of a bar of 80 × 20 × 20 mm, alternately on its two edges.
inline Eigen::Matrix3Xd PlacesOnBar(int count) {
  Eigen::Matrix3Xd places(3, count);
  for (int m = 0; m < count; ++m)
    places.col(m) << 0.005 + 0.07 * m / (count - 1), m % 2 == 0 ? 0.01 : -0.01, 0.01;
  return places;
}

// Three frames in which those markers for which moves(m) holds move by `step` in each. `held` is
// the entry of recording.yaml that says what holds the bar at x = 0. The first frame does not show
// the marker `hidden`.
template <typename Moves>
void WriteMarkers(const TemporaryFolder& folder, int count, const Eigen::Vector3d& step,
                  const Moves& moves, const std::string& held, int hidden = -1) {
  WriteBoxSurface(folder / "box.off", {0, -0.01, -0.01}, {0.08, 0.01, 0.01});
  const Eigen::Matrix3Xd places = PlacesOnBar(count);
  std::ofstream csv(folder / "markers.csv");
  csv << "t";
  for (int m = 0; m < count; ++m) csv << fmt::format(",m{0}_x,m{0}_y,m{0}_z", m);
  for (int frame = 0; frame < 3; ++frame) {
    csv << "\n" << frame;
    for (int m = 0; m < count; ++m) {
      if (frame == 0 && m == hidden) {
        csv << ",,,";
        continue;
      }
      const Eigen::Vector3d at =
          places.col(m) + (moves(m) ? frame * step : Eigen::Vector3d(0, 0, 0));
      csv << fmt::format(",{},{},{}", at.x(), at.y(), at.z());
    }
  }
  csv << "\n";
  std::ofstream(folder / "recording.yaml")
      << "schema_version: 1\nname: bar\nlength_unit: m\ndensity: 1000 kg/m^3\n"
      << MarkerFrames(places) << held
      << ", half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n"
      << "reference: {from: mesh, file: box.off}\n";
}

// The beginning of an entry `held` for WriteMarkers(): a clamp.
inline constexpr char kClamped[] = "fixed: [{name: clamp";

// A reconstruction of markers with what it was made from.
struct FollowedMarkers {
  ReconstructionStudy study;
  std::vector<FrameState> states;
  ReferenceBody reference;
  FollowedMotion motion;
  RunRecord record;
};

// One force at the end of the bar.
inline constexpr char kTipForce[] =
    "{model: footprint, force_scale: 0.01 N, region: {half_space: {point: [0.07 m, 0 m, 0 m], "
    "normal: [1, 0, 0]}}}";

// Follows the markers that were written into `folder` with these forces; `more` is added to the
// experiment.
inline FollowedMarkers Follow(const TemporaryFolder& folder, const std::string& more,
                              const std::string& forces = "{model: none}",
                              const std::string& motion = "{scheme: quasi_static}") {
  SilentProgress progress;
  FollowedMarkers followed;
  followed.study = ReadReconstruction(Config::Parse(
      "schema_version: 1\nname: markers\nrecording: " + folder.Path().string() +
          "\nmesh: {max_volume: 4000 mm^3}\nmaterial: {law: linear, young_modulus: 0.1 MPa, "
          "poisson_ratio: 0.3}\nmotion: " +
          motion + "\nforces: " + forces + "\n" + more,
      "markers.yaml"));
  followed.states = LoadFrameStates(followed.study, &progress);
  followed.reference = MakeReferenceBody(followed.study, followed.states.front());
  followed.motion = FollowFrames(followed.study, followed.reference, followed.states, &progress);
  followed.record =
      MeasureRun(followed.study, followed.reference, followed.states, followed.motion);
  return followed;
}

}  // namespace lacuna

#endif  // LACUNA_TESTS_RECONSTRUCTION_FOLLOWED_MARKERS_H_
