// lacuna simulate SCENE
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "experiment/scene.h"
#include "record/csv_table.h"
#include "report/vtk_files.h"

namespace lacuna {
namespace {

struct Arguments {
  std::string scene;
  std::string output;
  std::string recording;
};

// Nine components row by row, from xx, yy, zz, yz, xz, xy.
Eigen::MatrixXd AsTensors(const Eigen::MatrixXd& cauchy) {
  return cauchy({0, 5, 4, 5, 1, 3, 4, 3, 2}, Eigen::all);
}

// Writes the trajectory for ParaView, and the loads and the forces of the grips as a table.
void WriteSimulation(const SceneMotion& motion, const std::filesystem::path& folder) {
  std::vector<TimedFile> series;
  const Eigen::Index frames = static_cast<Eigen::Index>(motion.times.size());
  Eigen::MatrixXd loads(frames, 4);
  for (size_t k = 0; k < motion.times.size(); ++k) {
    TetMesh deformed = motion.body->mesh;
    deformed.nodes = motion.positions[k];
    const auto file = folder / fmt::format("body_{:04}.vtu", k);
    WriteVtu(file, deformed,
             {{{"displacement_m", motion.positions[k] - motion.body->mesh.nodes},
               {"velocity_m_per_s", motion.velocities[k]},
               {"cauchy_stress_Pa", AsTensors(motion.stress[k].cauchy)},
               {"von_mises_stress_Pa", motion.stress[k].von_mises.transpose()},
               {"principal_stretches", motion.stress[k].stretch}},
              {}});
    series.push_back({motion.times[k], file});
    loads.row(static_cast<Eigen::Index>(k)) << motion.times[k], motion.load[k].transpose();
  }
  WritePvd(folder / "body.pvd", series);
  CsvTable table{{"time_s", loads.col(0)},
                 {"load_x_N", loads.col(1)},
                 {"load_y_N", loads.col(2)},
                 {"load_z_N", loads.col(3)}};
  for (Eigen::Index row = 0; row < motion.reactions.rows(); ++row)
    table.push_back({fmt::format("grip_{}_{}_N", row / 3 + 1, "xyz"[row % 3]),
                     motion.reactions.row(row).head(frames)});
  for (Eigen::Index row = 0; row < motion.torques.rows(); ++row)
    table.push_back({fmt::format("grip_{}_torque_{}_N_m", row / 3 + 1, "xyz"[row % 3]),
                     motion.torques.row(row).head(frames)});
  SaveCsv(table, folder / "loads.csv");
}

int Simulate(const Arguments& arguments) {
  const Scene scene = ReadScene(Config::Load(arguments.scene));
  if (!arguments.recording.empty() && !scene.scanner)
    throw InputError(SourcePosition{arguments.scene}, "has no `scanner`, which --recording needs");
  const std::filesystem::path output =
      arguments.output.empty() ? "results/" + scene.name + "_simulation" : arguments.output;
  MakeFolder(output);
  if (!arguments.recording.empty()) MakeFolder(arguments.recording);
  Progress progress;
  const SceneMotion motion = SimulateScene(scene, &progress);
  if (!motion.IsUsable()) {
    fmt::print(stderr, "lacuna: {}: the simulation ended: {}\n", arguments.scene, motion.message);
    return 1;
  }
  fmt::print("{}: {} nodes, {} tetrahedra, {} frames, largest displacement {:.2f} mm\n", scene.name,
             motion.body->NodeCount(), motion.body->ElementCount(), motion.times.size(), [&] {
               double largest = 0;
               for (const auto& nodes : motion.positions)
                 largest = std::max(largest,
                                    (nodes - motion.body->mesh.nodes).colwise().norm().maxCoeff());
               return 1e3 * largest;
             }());
  WriteSimulation(motion, output);
  fmt::print("The trajectory was written to {}\n", (output / "body.pvd").string());
  if (!arguments.recording.empty()) {
    WriteSceneRecording(scene, motion, arguments.recording);
    fmt::print("The recording was written to {}\n", arguments.recording);
  }
  return 0;
}

}  // namespace

void AddSimulate(CLI::App* app, std::function<int()>* command) {
  CLI::App* simulate = app->add_subcommand(
      "simulate", "Simulate a synthetic scene and, with --recording, scan it with virtual cameras");
  auto arguments = std::make_shared<Arguments>();
  simulate->add_option("scene", arguments->scene, "The scene's YAML file")->required();
  simulate->add_option("-o,--output", arguments->output,
                       "Folder for the trajectory (default: results/<name>_simulation)");
  simulate->add_option("--recording", arguments->recording,
                       "Folder for the scans, a recording like any other that `reconstruct` reads");
  simulate->callback(
      [command, arguments] { *command = [arguments] { return Simulate(*arguments); }; });
}

}  // namespace lacuna
