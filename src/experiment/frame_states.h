// Stages 1 and 2 of the paper: the cleaned points and the surface of every frame.
#ifndef LACUNA_EXPERIMENT_FRAME_STATES_H_
#define LACUNA_EXPERIMENT_FRAME_STATES_H_

#include <Eigen/Core>
#include <filesystem>
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
  PointCloud cloud;  // cleaned, with normals where they can be told
  TriMesh surface;   // closed; without triangles where the frame has none
  // For tracked recordings: the material point of each row; NaN columns were not seen. Held-out
  // points are in `held_out`, not in `cloud` or `tracked`.
  Eigen::Matrix3Xd tracked;
  Eigen::Matrix3Xd held_out;
};

// Of a tracked frame, 3 × rows, m; NaN where a row was not seen.
Eigen::Matrix3Xd PointsByRow(const Frame& frame);

// The points that stand for the state in a registration: the surface's vertices, or the cloud.
PointCloud StatePoints(const FrameState& state);

// What is made of a frame.
struct FrameStateOptions {
  FilterOptions filter;
  SurfaceOptions surface;
  bool surfaces = true;    // Poisson surface of the points; else they stand for it
  int hold_out_every = 0;  // tracked points that are kept apart; 0: none
};
// Frame `frame` of the recording. Throws InputError naming it.
FrameState MakeFrameState(const Recording& recording, int frame, const FrameStateOptions& options);

// For the run directory.
void SaveFrameStates(const std::vector<FrameState>& states, const std::filesystem::path& folder);
std::vector<FrameState> ReadFrameStates(const std::filesystem::path& folder);

// The standard deviation of a cloud's points about their own surface, m: the median over the points
// of the distance from the plane through their neighbours, corrected for the plane's own error.
// Curvature adds to it.
double EstimateNoise(const Eigen::Matrix3Xd& points);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_FRAME_STATES_H_
