#include "experiment/frame_states.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/median.h"
#include "core/npy.h"
#include "experiment/grip_tracks.h"
#include "geometry/finite_columns.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

constexpr double kNotSeen = std::numeric_limits<double>::quiet_NaN();

bool IsHeldOut(Eigen::Index row, int every) { return every > 0 && row % every == every - 1; }

// Flags, one per row of a frame, of the markers that a grip follows.
std::vector<char> FollowedByGrips(const Recording& recording, Eigen::Index rows) {
  std::vector<char> followed(static_cast<size_t>(rows), 0);
  for (const RecordedGrip& grip : recording.object.grips)
    for (const int marker : MarkersOf(grip, recording)) followed[static_cast<size_t>(marker)] = 1;
  return followed;
}

// Splits tracked points into those that may be used and those that are held out.
void SplitTracked(const Recording& recording, const Frame& frame, int hold_out_every,
                  FrameState* state) {
  const Eigen::Matrix3Xd points = PointsByRow(frame);
  const TrackedRows rows = SplitRows(recording, points.cols(), hold_out_every);
  state->tracked = points(Eigen::all, rows.used);
  state->held_out = points(Eigen::all, rows.held_out);
  state->cloud.points = state->tracked(Eigen::all, FiniteColumns(state->tracked));
}

std::string NoteOnOrientation(const Orientation& orientation) {
  if (orientation.doubtful_component_count == 0) return "";
  return fmt::format(
      "which side is outside is uncertain for {} of {} connected parts of the points; `sensors` "
      "under `frames` of the recording would decide it",
      orientation.doubtful_component_count, orientation.component_count);
}

void RefuseFarSurface(const FrameState& state, const std::string& where) {
  const double size = BoundingBoxDiagonal(state.surface.vertices);
  const double mean = SurfaceSearch(state.surface).Nearest(state.cloud.points).distance.mean();
  if (mean <= kFarFromScan * size) return;
  throw InputError(fmt::format(
      "{}: the surface made from the points is {:.3g} mm from them on average, but only {:.3g} mm "
      "across: the points do not surround one object. Likely causes are camera poses or "
      "intrinsics that do not match the images, and other objects in the scan (`crop`, "
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

TrackedRows SplitRows(const Recording& recording, Eigen::Index count, int hold_out_every) {
  const std::vector<char> followed = FollowedByGrips(recording, count);
  TrackedRows rows;
  for (Eigen::Index row = 0; row < count; ++row) {
    const bool is_held_out = IsHeldOut(row, hold_out_every) && !followed[static_cast<size_t>(row)];
    (is_held_out ? rows.held_out : rows.used).push_back(row);
  }
  return rows;
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
  state.notes = frame.notes;
  if (!IsScan(recording)) {
    SplitTracked(recording, frame, options.hold_out_every, &state);
    return state;
  }
  if (frame.triangles.cols() > 0) {
    state.surface = {frame.cloud.points, frame.triangles};
    state.cloud = {frame.cloud.points, VertexNormals(state.surface)};
    return state;
  }
  const std::string where = fmt::format("{}: frame {}", recording.file.string(), frame_number);
  const FilterResult filtered =
      NamingWhere(where, [&] { return FilterCloud(frame.cloud, frame.sensors, options.filter); });
  state.cloud = filtered.cloud;
  if (std::string note = NoteOnOrientation(filtered.orientation); !note.empty())
    state.notes.push_back(std::move(note));
  if (!options.surfaces) return state;
  const Surface surface =
      NamingWhere(where, [&] { return ReconstructSurface(state.cloud, options.surface); });
  if (!surface.IsUsable()) throw InputError(where + ": no closed surface: " + surface.message);
  state.surface = surface.mesh;
  for (const std::string& note : surface.notes) state.notes.push_back("the surface: " + note);
  RefuseFarSurface(state, where);
  return state;
}

void WriteFrameStates(const std::vector<FrameState>& states, const std::filesystem::path& folder) {
  Eigen::VectorXd times(states.size());
  nlohmann::json notes = nlohmann::json::array();
  for (size_t k = 0; k < states.size(); ++k) {
    const FrameState& state = states[k];
    times[static_cast<Eigen::Index>(k)] = state.time;
    WriteNpy(FrameFile(folder, k, "points"), state.cloud.points);
    WriteNpy(FrameFile(folder, k, "normals"), state.cloud.normals);
    WriteNpy(FrameFile(folder, k, "vertices"), state.surface.vertices);
    WriteNpyIntegers(FrameFile(folder, k, "triangles"), state.surface.triangles.cast<int64_t>());
    WriteNpy(FrameFile(folder, k, "tracked"), state.tracked);
    WriteNpy(FrameFile(folder, k, "held_out"), state.held_out);
    notes.push_back(state.notes);
  }
  WriteFileAtomically(folder / "notes.json",
                      notes.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n");
  WriteNpy(folder / "times.npy", times);
}

std::vector<FrameState> ReadFrameStates(const std::filesystem::path& folder) {
  const Eigen::MatrixXd times = ReadNpyMatrix(folder / "times.npy");
  std::vector<FrameState> states(static_cast<size_t>(times.size()));
  using Notes = std::vector<std::vector<std::string>>;
  const Notes notes = ReadJsonFile(
      folder / "notes.json", [](const nlohmann::json& content) { return content.get<Notes>(); });
  if (notes.size() != states.size())
    throw InputError(SourcePosition{(folder / "notes.json").string()},
                     fmt::format("has the notes of {} frames; expected those of {}", notes.size(),
                                 states.size()));
  for (size_t k = 0; k < states.size(); ++k) {
    states[k].time = times(static_cast<Eigen::Index>(k));
    states[k].cloud.points = ReadPoints(FrameFile(folder, k, "points"));
    states[k].cloud.normals = ReadPoints(FrameFile(folder, k, "normals"));
    states[k].surface.vertices = ReadPoints(FrameFile(folder, k, "vertices"));
    states[k].surface.triangles = ReadNpyIntegers(FrameFile(folder, k, "triangles")).cast<int>();
    states[k].tracked = ReadPoints(FrameFile(folder, k, "tracked"));
    states[k].held_out = ReadPoints(FrameFile(folder, k, "held_out"));
    states[k].notes = notes[k];
  }
  return states;
}

double EstimateNoise(const Eigen::Matrix3Xd& points) {
  constexpr int kNeighbours = kFewestNoisePoints - 1;
  if (points.cols() < kFewestNoisePoints) return 0;
  const PointHits near = PointSearch(points).Nearest(points, kNeighbours);
  std::vector<double> deviation(static_cast<size_t>(points.cols()));
  for (Eigen::Index j = 0; j < points.cols(); ++j) {
    Eigen::Matrix<double, 3, kNeighbours> local;
    for (int k = 0; k < kNeighbours; ++k) local.col(k) = points.col(near.index(k, j));
    local.colwise() -= local.rowwise().mean().eval();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(local * local.transpose(),
                                                              Eigen::EigenvaluesOnly);
    // A plane has three of the degrees of freedom.
    deviation[static_cast<size_t>(j)] =
        std::sqrt(std::max(0.0, axes.eigenvalues()[0]) / (kNeighbours - 3));
  }
  return Median(std::move(deviation));
}

}  // namespace lacuna
