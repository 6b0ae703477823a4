#include "experiment/frame_states.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/npy.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

constexpr double kNotSeen = std::numeric_limits<double>::quiet_NaN();

bool IsHeldOut(Eigen::Index row, int every) { return every > 0 && row % every == every - 1; }

// Splits tracked points into those that may be used and those that are held out.
void SplitTracked(const Frame& frame, int hold_out_every, FrameState* state) {
  const Eigen::Matrix3Xd points = PointsByRow(frame);
  std::vector<Eigen::Index> used, held_out;
  for (Eigen::Index row = 0; row < points.cols(); ++row)
    (IsHeldOut(row, hold_out_every) ? held_out : used).push_back(row);
  state->tracked = points(Eigen::all, used);
  state->held_out = points(Eigen::all, held_out);
  std::vector<Eigen::Index> seen;
  for (Eigen::Index j = 0; j < state->tracked.cols(); ++j)
    if (state->tracked.col(j).allFinite()) seen.push_back(j);
  state->cloud.points = state->tracked(Eigen::all, seen);
}

void RefuseFarSurface(const FrameState& state, const std::string& where) {
  const double size = BoundingBoxDiagonal(state.surface.vertices);
  const double mean = SurfaceSearch(state.surface).Nearest(state.cloud.points).distance.mean();
  if (mean <= kFarFromScan * size) return;
  throw InputError(fmt::format(
      "{}: the surface made from the points is {:.3g} mm from them on average, but only {:.3g} mm "
      "across: the points do not surround one object. Likely causes are poses or intrinsics of the "
      "cameras that do not belong to the images, and other objects in the scan (`crop`, "
      "`keep_largest` and `filter` leave them out)",
      where, 1e3 * mean, 1e3 * size));
}

std::filesystem::path FrameFile(const std::filesystem::path& folder, size_t k, const char* what) {
  return folder / fmt::format("{}_{:04}.npy", what, k);
}

Eigen::Matrix3Xd ReadPoints(const std::filesystem::path& file) {
  const Eigen::MatrixXd matrix = ReadNpyMatrix(file);
  if (matrix.rows() != 3) throw InputError(SourcePosition{file.string()}, "expected three rows");
  return matrix;
}

}  // namespace

Eigen::Matrix3Xd PointsByRow(const Frame& frame) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Constant(3, frame.row_count, kNotSeen);
  for (Eigen::Index j = 0; j < frame.cloud.Size(); ++j)
    points.col(frame.source_row[j]) = frame.cloud.points.col(j);
  return points;
}

PointCloud StatePoints(const FrameState& state) {
  if (state.surface.triangles.cols() == 0) return state.cloud;
  return {state.surface.vertices, VertexNormals(state.surface)};
}

FrameState MakeFrameState(const Recording& recording, int frame_number,
                          const FrameStateOptions& options) {
  const Frame frame = LoadFrame(recording, frame_number);
  FrameState state;
  state.time = frame.time;
  if (!IsScan(recording)) {
    SplitTracked(frame, options.hold_out_every, &state);
    return state;
  }
  if (frame.triangles.cols() > 0) {
    state.surface = {frame.cloud.points, frame.triangles};
    state.cloud = {frame.cloud.points, VertexNormals(state.surface)};
    return state;
  }
  const std::string where = fmt::format("{}: frame {}", recording.file.string(), frame_number);
  state.cloud = NamingWhere(
      where, [&] { return FilterCloud(frame.cloud, frame.sensors, options.filter).cloud; });
  if (!options.surfaces) return state;
  const Surface surface =
      NamingWhere(where, [&] { return ReconstructSurface(state.cloud, options.surface); });
  if (!surface.IsUsable()) throw InputError(where + ": no closed surface: " + surface.message);
  state.surface = surface.mesh;
  RefuseFarSurface(state, where);
  return state;
}

void SaveFrameStates(const std::vector<FrameState>& states, const std::filesystem::path& folder) {
  Eigen::VectorXd times(states.size());
  for (size_t k = 0; k < states.size(); ++k) {
    const FrameState& state = states[k];
    times[static_cast<Eigen::Index>(k)] = state.time;
    WriteNpy(FrameFile(folder, k, "points"), state.cloud.points);
    WriteNpy(FrameFile(folder, k, "normals"), state.cloud.normals);
    WriteNpy(FrameFile(folder, k, "vertices"), state.surface.vertices);
    WriteNpyIntegers(FrameFile(folder, k, "triangles"), state.surface.triangles.cast<int64_t>());
    WriteNpy(FrameFile(folder, k, "tracked"), state.tracked);
    WriteNpy(FrameFile(folder, k, "held_out"), state.held_out);
  }
  WriteNpy(folder / "times.npy", times);
}

std::vector<FrameState> ReadFrameStates(const std::filesystem::path& folder) {
  const Eigen::MatrixXd times = ReadNpyMatrix(folder / "times.npy");
  std::vector<FrameState> states(static_cast<size_t>(times.size()));
  for (size_t k = 0; k < states.size(); ++k) {
    states[k].time = times(static_cast<Eigen::Index>(k));
    states[k].cloud.points = ReadPoints(FrameFile(folder, k, "points"));
    states[k].cloud.normals = ReadPoints(FrameFile(folder, k, "normals"));
    states[k].surface.vertices = ReadPoints(FrameFile(folder, k, "vertices"));
    states[k].surface.triangles = ReadNpyIntegers(FrameFile(folder, k, "triangles")).cast<int>();
    states[k].tracked = ReadPoints(FrameFile(folder, k, "tracked"));
    states[k].held_out = ReadPoints(FrameFile(folder, k, "held_out"));
  }
  return states;
}

double EstimateNoise(const Eigen::Matrix3Xd& points) {
  constexpr int kNeighbours = 16;
  if (points.cols() < kNeighbours + 1) return 0;
  const PointHits near = PointSearch(points).Nearest(points, kNeighbours);
  std::vector<double> deviation(static_cast<size_t>(points.cols()));
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    Eigen::Matrix<double, 3, kNeighbours> local;
    for (int k = 0; k < kNeighbours; ++k) local.col(k) = points.col(near.index(k, j));
    local.colwise() -= local.rowwise().mean().eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(local * local.transpose(),
                                                              Eigen::EigenvaluesOnly);
    // A plane has three of the sixteen degrees of freedom.
    deviation[static_cast<size_t>(j)] =
        std::sqrt(std::max(0.0, axes.eigenvalues()[0]) / (kNeighbours - 3));
  }
  const auto middle = deviation.begin() + static_cast<std::ptrdiff_t>(deviation.size() / 2);
  std::nth_element(deviation.begin(), middle, deviation.end());
  return *middle;
}

}  // namespace lacuna
