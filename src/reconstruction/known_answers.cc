#include "reconstruction/known_answers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/error.h"
#include "geometry/mesh_io.h"
#include "scan/scan_writer.h"

namespace lacuna {
namespace {

[[noreturn]] void RefuseArray(const std::filesystem::path& file, const std::vector<int64_t>& shape,
                              const std::string& expected) {
  throw InputError(
      SourcePosition{file.string()},
      fmt::format("is an array of {}; expected {}",
                  shape.empty() ? "one number" : fmt::format("{}", fmt::join(shape, " × ")),
                  expected));
}

void RequireFrames(const std::filesystem::path& file, int64_t count,
                   const std::vector<int>& frames) {
  const int last = *std::max_element(frames.begin(), frames.end());
  if (last < count) return;
  throw InputError(SourcePosition{file.string()},
                   fmt::format("has {} frames, from 0; frame {} is followed", count, last));
}

}  // namespace

Eigen::Matrix3Xd TruePositions::At(int frame) const {
  const auto points = static_cast<Eigen::Index>(of_recording.shape[1]);
  const Eigen::Map<const Eigen::Matrix3Xd> all(of_recording.values.data() + 3 * points * frame, 3,
                                               points);
  return all(Eigen::all, point);
}

TruePositions ReadTruePositions(const ValidationSettings& validation,
                                const std::vector<int>& frames) {
  const TetMeshFile mesh = ReadTetMesh(validation.true_mesh);
  TruePositions truth{mesh.mesh.nodes, mesh.node_in_file, ReadNpy(validation.true_positions)};
  const std::vector<int64_t>& shape = truth.of_recording.shape;
  if (shape.size() != 3 || shape[2] != 3)
    RefuseArray(validation.true_positions, shape, "frames × points × 3");
  // The file of the mesh may have nodes behind the last one that a tetrahedron uses.
  const int needed = truth.point.maxCoeff() + 1;
  if (shape[1] < needed)
    throw InputError(SourcePosition{validation.true_positions.string()},
                     fmt::format("has {} points in each frame; the tetrahedra of {} use {} nodes",
                                 shape[1], validation.true_mesh.string(), needed));
  RequireFrames(validation.true_positions, shape[0], frames);
  return truth;
}

Eigen::MatrixXd ReadTrueForces(const ValidationSettings& validation,
                               const std::vector<int>& frames) {
  const NpyArray forces = ReadNpy(validation.true_forces);
  if (forces.shape.size() != 2 || forces.shape[1] != 3)
    RefuseArray(validation.true_forces, forces.shape, "frames × 3");
  RequireFrames(validation.true_forces, forces.shape[0], frames);
  return Eigen::Map<const Eigen::Matrix3Xd>(forces.values.data(), 3, forces.shape[0]).transpose();
}

TriMesh ReadTrueSurface(const ValidationSettings& validation, int frame) {
  return ReadTrueSurface(validation.true_surfaces.parent_path(), frame);
}

void RequireLengthUnit(const std::filesystem::path& file, const Eigen::Matrix3Xd& points,
                       const Eigen::Matrix3Xd& seen) {
  constexpr double kMostSizes = 10;
  const Eigen::AlignedBox3d here = BoundingBox(points), there = BoundingBox(seen);
  const double size = there.diagonal().norm(), distance = (here.center() - there.center()).norm();
  if (!(size > 0) || !(std::max(here.diagonal().norm(), distance) > kMostSizes * size)) return;
  throw InputError(
      SourcePosition{file.string()},
      fmt::format(
          "has points in a box of {:.3g} m, {:.3g} m from the centre of the recorded ones, "
          "whose box is {:.3g} m across; its lengths must be in m, in the coordinate system "
          "of the recording",
          here.diagonal().norm(), distance, size));
}

std::vector<std::pair<std::string, std::filesystem::path>> FilesOfKnownAnswers(
    const ValidationSettings& validation, const std::vector<int>& frames) {
  std::vector<std::pair<std::string, std::filesystem::path>> files;
  const auto add = [&files](const char* key, const std::filesystem::path& file) {
    files.emplace_back(fmt::format("{}/{}", key, file.filename().string()), file);
  };
  if (!validation.true_positions.empty()) add("true_positions", validation.true_positions);
  if (!validation.true_mesh.empty())
    for (const auto& file : FilesOfTetMesh(validation.true_mesh)) add("true_mesh", file);
  if (!validation.true_forces.empty()) add("true_forces", validation.true_forces);
  if (!validation.true_surfaces.empty())
    for (const auto& file : FilesOfTrueSurfaces(validation.true_surfaces.parent_path(), frames))
      add("true_surfaces", file);
  return files;
}

}  // namespace lacuna
