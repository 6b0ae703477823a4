// lacuna simulate SCENE, or EXPERIMENT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdint>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <system_error>
#include <vector>

#include "app/commands.h"
#include "app/output_options.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "core/file_name.h"
#include "core/hash.h"
#include "experiment/listed_regions.h"
#include "experiment/model_reader.h"
#include "experiment/scene.h"
#include "geometry/mesh_io.h"
#include "prediction/played_recording.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study_reader.h"
#include "prediction/recorded_motion.h"
#include "record/csv_table.h"
#include "report/vtk_files.h"
#include "scan/recording_writer.h"

namespace lacuna {
namespace {

struct Arguments {
  std::string scene;
  std::string output;
  std::string recording;
  std::optional<uint64_t> seed;
};

// Nine components row by row, from xx, yy, zz, yz, xz, xy.
Eigen::MatrixXd AsTensors(const Eigen::MatrixXd& cauchy) {
  return cauchy({0, 5, 4, 5, 1, 3, 4, 3, 2}, Eigen::all);
}

struct Trajectory {
  const TetMesh& mesh;
  const std::vector<double>& times;
  const std::vector<Eigen::Matrix3Xd>& positions;
  const std::vector<Eigen::Matrix3Xd>& velocities;
  const std::vector<NodalStress>* stress = nullptr;  // null: not computed

  double LargestDisplacement() const {
    double largest = 0;
    for (const Eigen::Matrix3Xd& nodes : positions)
      largest = std::max(largest, (nodes - mesh.nodes).colwise().norm().maxCoeff());
    return largest;
  }
};

// Writes the trajectory for ParaView.
void WriteTrajectory(const Trajectory& motion, const std::filesystem::path& folder) {
  std::vector<TimedFile> series;
  for (size_t k = 0; k < motion.times.size(); ++k) {
    TetMesh deformed = motion.mesh;
    deformed.nodes = motion.positions[k];
    std::vector<Field> fields = {{"displacement_m", motion.positions[k] - motion.mesh.nodes},
                                 {"velocity_m_per_s", motion.velocities[k]}};
    if (motion.stress != nullptr) {
      const NodalStress& stress = (*motion.stress)[k];
      fields.push_back({"cauchy_stress_Pa", AsTensors(stress.cauchy)});
      fields.push_back({"von_mises_stress_Pa", stress.von_mises.transpose()});
      fields.push_back({"principal_stretches", stress.stretch});
    }
    const auto file = folder / fmt::format("body_{:04}.vtu", k);
    WriteVtu(file, deformed, {std::move(fields), {}});
    series.push_back({motion.times[k], file});
  }
  WritePvd(folder / "body.pvd", series);
}

// Writes the loads and the forces of the grips as a table.
void WriteLoads(const SceneMotion& motion, const std::filesystem::path& folder) {
  const Eigen::Index frames = static_cast<Eigen::Index>(motion.times.size());
  Eigen::MatrixXd loads(frames, 4);
  for (size_t k = 0; k < motion.times.size(); ++k)
    loads.row(static_cast<Eigen::Index>(k)) << motion.times[k], motion.load[k].transpose();
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
  WriteCsv(table, folder / "loads.csv");
}

int SayEnded(const Arguments& arguments, const std::string& why) {
  fmt::print(stderr, "lacuna: {}: the simulation ended: {}\n", arguments.scene, why);
  return 1;
}

void SayMotion(const std::string& name, const TetMesh& mesh, const Trajectory& trajectory,
               const std::filesystem::path& folder) {
  fmt::print(
      "{}: {} nodes, {} tetrahedra, {} frames, largest displacement {:.2f} mm\n"
      "The trajectory was written to {}\n",
      name, mesh.NodeCount(), mesh.TetCount(), trajectory.times.size(),
      1e3 * trajectory.LargestDisplacement(), (folder / "body.pvd").string());
}

std::filesystem::path OutputFolder(const Arguments& arguments, const std::string& name) {
  return arguments.output.empty() ? "results/" + name + "_simulation" : arguments.output;
}

// Throws InputError where the recording would be written among files that may be measured.
void RefuseMeasuredFiles(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder) || IsSimulatedRecording(folder)) return;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (!IsTemporaryFile(entry.path()))
      throw InputError({folder.string()},
                       fmt::format("contains {}, but no recording.yaml that begins with \"# {}\"; "
                                   "choose another folder for --recording",
                                   entry.path().filename().string(), kSimulated));
}

// Marks a folder that has been checked before anything else is written into it, so that the
// command can be repeated after an interruption. A simulated recording that is there is kept until
// the new one is written.
void ReserveFolder(const std::filesystem::path& folder) {
  MakeFolder(folder);
  if (!IsSimulatedRecording(folder)) MarkAsSimulated(folder);
}

// Throws InputError where the recording would be written among files that the experiment reads.
void RefuseFolderOfInputs(const std::filesystem::path& folder, const PredictionStudy& study) {
  std::error_code absent;  // a folder that does not exist is none of theirs
  for (const PredictedRecording& item : study.recordings)
    for (const FileState& input : item.recording.files)
      if (std::filesystem::equivalent(folder, std::filesystem::absolute(input.file).parent_path(),
                                      absent))
        throw InputError({folder.string()},
                         fmt::format("contains {}, which the experiment reads; choose another "
                                     "folder for --recording",
                                     input.file.filename().string()));
}

// Recordings of different experiments or names have different errors; `seed` gives others.
uint64_t SeedOf(const std::string& experiment, const std::string& recording, uint64_t seed) {
  const std::string hash = HashBytes(fmt::format("{}\n{}\n{}", experiment, recording, seed));
  return std::stoull(hash.substr(0, 16), nullptr, 16);
}

// Plays the recordings of an experiment with its model, each into a folder of its own where there
// are several.
int PlayExperiment(const Arguments& arguments, const Config& config) {
  const PredictionStudy study = ReadPredictionStudy(config);
  PrintWarnings(OutputOptions{}, AuxeticWarnings(study));
  std::set<std::string> folders;
  for (const PredictedRecording& item : study.recordings) {
    if (item.ShowsScans())
      throw InputError(SourcePosition{arguments.scene},
                       fmt::format("recording {} contains scans; only recordings of markers "
                                   "can be simulated",
                                   item.name));
    if (!folders.insert(FileNameFor(item.name)).second)
      throw InputError(SourcePosition{arguments.scene},
                       fmt::format("recording {} would have the same folder, {}, as another; give "
                                   "it another name",
                                   item.name, FileNameFor(item.name)));
  }
  const bool several = study.recordings.size() > 1;
  const auto own_folder = [&](const std::filesystem::path& folder, const std::string& name) {
    return several ? folder / FileNameFor(name) : folder;
  };
  if (!arguments.recording.empty()) {
    std::vector<std::filesystem::path> written;
    for (const PredictedRecording& item : study.recordings)
      written.push_back(own_folder(arguments.recording, item.name));
    for (const std::filesystem::path& folder : written) {
      RefuseFolderOfInputs(folder, study);
      RefuseMeasuredFiles(folder);
    }
    for (const std::filesystem::path& folder : written) ReserveFolder(folder);
  }
  const TetMesh mesh = MakeReferenceBody(study).mesh;
  const auto body = std::make_shared<const Body>(MakeBody(mesh, study.density));
  for (const PredictedRecording& item : study.recordings) {
    const RecordingModel model(study, item, mesh, body, {});
    const PlayedRecording played = Play(model, PlayedNuisances(model));
    if (!played.summary.IsUsable())
      return SayEnded(arguments, item.name + ": " + played.summary.message);
    const std::filesystem::path folder = own_folder(OutputFolder(arguments, study.name), item.name);
    MakeFolder(folder);
    const Trajectory trajectory{body->mesh, played.times, played.positions, played.velocities};
    WriteTrajectory(trajectory, folder);
    SayMotion(item.name, mesh, trajectory, folder);
    if (arguments.recording.empty()) continue;
    const std::filesystem::path written = own_folder(arguments.recording, item.name);
    MarkAsSimulated(written);
    WriteTetMesh(written / "object.msh", mesh);
    MarkerRecording recording = AsRecording(
        item, played, study.noise, SeedOf(study.name, item.name, arguments.seed.value_or(0)));
    recording.reference = written / "object.msh";
    ListNodesOfMesh(mesh, RegionsIn(&recording.object));
    recording.comment =
        fmt::format("{}\nPlayed from {}.", kSimulated, study.file.filename().string());
    WriteMarkerRecording(written, recording);
    fmt::print("The recording was written to {}{}\n", written.string(),
               study.noise > 0 ? ""
                               : "; its markers have no errors, because the experiment gives no "
                                 "`noise` above 0");
    if (study.noise > 0 && !item.recording.markers.weights.empty())
      fmt::print(
          "The simulated errors of all its points are those of the experiment's `noise`; the "
          "values that {} gives for single points were not used\n",
          item.recording.file.string());
  }
  return 0;
}

int Simulate(const Arguments& arguments) {
  const Config config = Config::Load(arguments.scene);
  if (IsPredictionStudy(config)) return PlayExperiment(arguments, config);
  if (arguments.seed)
    throw InputError(SourcePosition{arguments.scene},
                     "is a scene, which has its `seed` in the file: leave out --seed");
  const Scene scene = ReadScene(config);
  if (const std::string warning = AuxeticWarning(scene.effects); !warning.empty())
    PrintWarnings(OutputOptions{}, {warning});
  if (!arguments.recording.empty() && !scene.scanner)
    throw InputError(SourcePosition{arguments.scene}, "has no `scanner`, which --recording needs");
  const std::filesystem::path output = OutputFolder(arguments, scene.name);
  if (!arguments.recording.empty()) {
    RefuseMeasuredFiles(arguments.recording);
    ReserveFolder(arguments.recording);
  }
  MakeFolder(output);
  Progress progress;
  const SceneMotion motion = SimulateScene(scene, &progress);
  if (!motion.IsUsable()) return SayEnded(arguments, motion.message);
  const Trajectory trajectory{motion.body->mesh, motion.times, motion.positions, motion.velocities,
                              &motion.stress};
  WriteTrajectory(trajectory, output);
  WriteLoads(motion, output);
  SayMotion(scene.name, motion.body->mesh, trajectory, output);
  if (!arguments.recording.empty()) {
    MarkAsSimulated(arguments.recording);
    WriteSceneRecording(scene, motion, arguments.recording);
    fmt::print("The recording was written to {}\n", arguments.recording);
  }
  return 0;
}

}  // namespace

void AddSimulate(CLI::App* app, std::function<int()>* command) {
  CLI::App* simulate = app->add_subcommand(
      "simulate",
      "Simulate a synthetic scene or an experiment, and optionally write recordings of the motion");
  simulate->footer(
      "For a scene, --recording writes the scans of virtual cameras. For an experiment with\n"
      "`recordings`, each of them is simulated with the model and the parameters of the\n"
      "experiment file, and --recording writes the motion of the markers.");
  auto arguments = std::make_shared<Arguments>();
  simulate->add_option("scene", arguments->scene, "The YAML file of the scene or the experiment")
      ->required();
  simulate->add_option("-o,--output", arguments->output,
                       "Folder for the trajectory (default: results/<name>_simulation)");
  simulate->add_option("--recording", arguments->recording,
                       "Folder for a recording, which `reconstruct` or `fit` can read");
  simulate->add_option("--seed", arguments->seed,
                       "Seed of the measurement errors in the recordings of an experiment "
                       "(default: 0)");
  simulate->callback(
      [command, arguments] { *command = [arguments] { return Simulate(*arguments); }; });
}

}  // namespace lacuna
