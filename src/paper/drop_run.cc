#include "paper/drop_run.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/json_file.h"
#include "core/npy.h"
#include "geometry/mesh_io.h"
#include "record/run_directory.h"
#include "record/run_stage.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

// Raised whenever a change of the code changes what MeasureDrop computes from a motion, or the
// files below. The motion itself has kSceneVersion (experiment/scene.h).
constexpr int kDropVersion = 1;

// A simulation at the scene's steps.
struct DrawnDrop {
  DropMotion motion;
  DropNumbers numbers;
};

nlohmann::json OptionsOf(const DropStudy& study, const DropMesh& mesh, int step_divisor) {
  const TetOptions& tets = mesh.settings.tets;
  return {{"scene_version", kSceneVersion},
          {"scene", study.scene_configuration},
          {"step_divisor", step_divisor},
          {"edge_length_m", mesh.edge_length},
          {"order", mesh.settings.order},
          {"radius_edge_ratio", tets.radius_edge_ratio},
          {"min_dihedral_angle_rad", tets.min_dihedral_angle},
          {"max_volume_m3", tets.max_volume},
          {"preserve_surface", tets.preserve_surface}};
}

SceneMotion Simulate(const Scene& scene, const DropMesh& mesh, Progress* progress) {
  return NamingWhere(
      fmt::format("the drop of {} nodes, order {}", mesh.paper_nodes, mesh.settings.order),
      [&] { return SimulateWholeScene(scene, progress); });
}

void WriteNumbers(const DropNumbers& numbers, const fs::path& folder) {
  WriteFileAtomically(folder / "numbers.json", ToJson(numbers).dump(2) + "\n");
}

DropNumbers ReadNumbers(const fs::path& folder) {
  return ReadJsonFile(folder / "numbers.json", DropNumbersFrom);
}

void WriteDrawnDrop(const DrawnDrop& drop, const fs::path& folder) {
  const DropMotion& motion = drop.motion;
  const auto frames = static_cast<Eigen::Index>(motion.times.size());
  Eigen::MatrixXd positions(3 * motion.body->mesh.NodeCount(), frames);
  for (Eigen::Index k = 0; k < frames; ++k)
    positions.col(k) = motion.positions[static_cast<size_t>(k)].reshaped();
  WriteTetMesh(folder / "body.msh", motion.body->mesh);
  WriteNpy(folder / "times.npy", Eigen::Map<const Eigen::VectorXd>(motion.times.data(), frames));
  WriteNpy(folder / "positions.npy", positions);
  WriteNumbers(drop.numbers, folder);
}

DrawnDrop ReadDrawnDrop(double density, const fs::path& folder) {
  DrawnDrop drop;
  DropMotion& motion = drop.motion;
  motion.body = std::make_shared<Body>(MakeBody(ReadTetMesh(folder / "body.msh").mesh, density));
  const Eigen::VectorXd times = ReadNpyMatrix(folder / "times.npy").reshaped();
  motion.times.assign(times.begin(), times.end());
  const Eigen::MatrixXd positions = ReadNpyMatrix(folder / "positions.npy");
  for (const auto frame : positions.colwise())
    motion.positions.emplace_back(frame.reshaped(3, motion.body->mesh.NodeCount()));
  drop.numbers = ReadNumbers(folder);
  return drop;
}

}  // namespace

std::vector<DropRun> RunDrop(const DropStudy& study, const fs::path& folder, Progress* progress) {
  RunDirectory run(folder);
  run.Begin({{"scene", study.scene_configuration}}, {}, 0);
  std::vector<DropRun> drops;
  for (const DropMesh& mesh : study.meshes) {
    const std::string name = fmt::format("mesh_{}", drops.size() + 1);
    const DrawnDrop drawn = RunStage<DrawnDrop>(
        &run, {name, kDropVersion, OptionsOf(study, mesh, 1), {}}, progress,
        [&] {
          const Scene scene = SceneOf(study, mesh, 1);
          const SceneMotion motion = Simulate(scene, mesh, progress);
          return DrawnDrop{{motion.body, motion.times, motion.positions},
                           MeasureDrop(scene, motion)};
        },
        WriteDrawnDrop,
        [&](const fs::path& stage) { return ReadDrawnDrop(study.scene.density, stage); });
    const DropNumbers halved = RunStage<DropNumbers>(
        &run, {name + "_halved", kDropVersion, OptionsOf(study, mesh, 2), {}}, progress,
        [&] {
          const Scene scene = SceneOf(study, mesh, 2);
          return MeasureDrop(scene, Simulate(scene, mesh, progress));
        },
        WriteNumbers, ReadNumbers);
    drops.push_back({mesh, drawn.motion, drawn.numbers, halved});
  }
  run.Finish();
  return drops;
}

}  // namespace lacuna
