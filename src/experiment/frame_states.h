// Stages 1 and 2 of the paper: the cleaned points and the surface of every frame.
#ifndef LACUNA_EXPERIMENT_FRAME_STATES_H_
#define LACUNA_EXPERIMENT_FRAME_STATES_H_

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/point_cloud.h"
#include "geometry/tri_mesh.h"
#include "scan/filter.h"
#include "scan/recording.h"
#include "surface/reconstruct.h"

namespace lacuna {

// One state S_k of the object.
struct FrameState {
  double time = 0;   // s
  PointCloud cloud;  // cleaned, with normals where they can be oriented
  TriMesh surface;   // closed; empty where the frame has none
  // For tracked recordings, the material point of each row; columns are NaN where it was not seen.
  // Held-out points are in `held_out` and neither in `cloud` nor in `tracked`.
  Eigen::Matrix3Xd tracked;
  Eigen::Matrix3Xd held_out;
  // Doubts about the frame's files, points and surface, and repairs of the surface, a clause each.
  std::vector<std::string> notes;
};

// The points of a tracked frame by row, 3 × rows, m; NaN where a row was not seen.
Eigen::Matrix3Xd PointsByRow(const Frame& frame);

// The rows of tracked points, ascending, as FrameState::tracked and ::held_out contain them.
struct TrackedRows {
  std::vector<Eigen::Index> used, held_out;
};
// Splits rows 0 … count − 1 of a tracked recording. Of every `hold_out_every` (0: none) rows the
// last is held out, except markers that a grip follows, because they move the model.
TrackedRows SplitRows(const Recording& recording, Eigen::Index count, int hold_out_every);

// The points that represent the state in a registration: the surface's vertices or, without a
// surface, the cloud.
PointCloud StatePoints(const FrameState& state);

// How a frame is processed.
struct FrameStateOptions {
  FilterOptions filter;
  SurfaceOptions surface;
  bool surfaces = true;  // reconstruct a Poisson surface; otherwise the points represent the state
  // Hold out every k-th tracked point (SplitRows); 0: none.
  int hold_out_every = 0;
};

// A surface or model farther than this from the points of its own frame, as a fraction of its size,
// is no description of them. Scanners err by less than a hundredth of the size, and a model that
// follows by less than a twentieth, while wrong units, intrinsics and poses lead to a quarter and
// more.
inline constexpr double kFarFromScan = 0.1;

// Processes one frame of the recording. Throws InputError, which names the frame, where it cannot
// be read, has no closed surface, or has one whose mean distance from the points is kFarFromScan.
FrameState MakeFrameState(const Recording& recording, int frame_number,
                          const FrameStateOptions& options);

// The files of a run directory: arrays in .npy format, one set per frame, and notes.json.
void WriteFrameStates(const std::vector<FrameState>& states, const std::filesystem::path& folder);
std::vector<FrameState> ReadFrameStates(const std::filesystem::path& folder);

// EstimateNoise compares each point with all but one of so many points around it.
inline constexpr int kFewestNoisePoints = 17;

// The standard deviation of a cloud's points (3 × n, m) about their own surface, m: the median over
// the points of the rms distance of their neighbours from the plane through them, corrected for the
// degrees of freedom of the plane. Curvature increases it. 0 for fewer than
// kFewestNoisePoints.
double EstimateNoise(const Eigen::Matrix3Xd& points);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_FRAME_STATES_H_
