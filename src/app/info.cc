// lacuna info FILE
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <numbers>

#include "app/commands.h"
#include "calibration/calibration_run.h"
#include "core/config.h"
#include "core/error.h"
#include "core/hash.h"
#include "experiment/scatter_findings.h"
#include "geometry/mesh_io.h"
#include "geometry/surface_check.h"
#include "meshing/tet_quality.h"
#include "prediction/prediction_study_reader.h"
#include "record/manifest.h"
#include "record/run_directory.h"
#include "record/run_record.h"
#include "report/calibration_report.h"
#include "report/diagnosis_report.h"
#include "scan/recording.h"

namespace lacuna {
namespace {

// The size of a mesh and where it lies.
std::string InOwnUnit(const Eigen::AlignedBox3d& box) {
  const Eigen::Vector3d size = box.sizes(), min = box.min(), max = box.max();
  return fmt::format(
      "{:.6g} x {:.6g} x {:.6g}, from ({:.6g}, {:.6g}, {:.6g}) to ({:.6g}, {:.6g}, {:.6g}) in the "
      "file's own unit",
      size.x(), size.y(), size.z(), min.x(), min.y(), min.z(), max.x(), max.y(), max.z());
}

void DescribeSurface(const std::filesystem::path& file) {
  const TriMeshFile read = ReadTriMesh(file);
  const SurfaceReport report = CheckSurface(read.mesh);
  const Eigen::AlignedBox3d box = BoundingBox(read.mesh.vertices);
  const auto say = [](bool yes) { return yes ? "yes" : "no"; };
  fmt::print("{}: a surface\n  vertices {}, triangles {}, components {}\n", file.string(),
             report.vertices, report.triangles, report.components);
  fmt::print("  size {}, area {:.6g}, volume {:.6g}\n", InOwnUnit(box), report.area, report.volume);
  fmt::print("  edges {:.4g} to {:.4g}, mean {:.4g}; smallest angle {:.1f} deg\n", report.min_edge,
             report.max_edge, report.mean_edge, report.min_angle * 180 / std::numbers::pi);
  fmt::print("  closed {}, manifold {}, consistently oriented {}, free of self-intersections {}\n",
             say(report.IsClosed()), say(report.IsManifold()), say(report.IsOriented()),
             say(report.IsFreeOfIntersections()));
  for (const std::string& note : read.notes) fmt::print("  note: {}\n", note);
}

void DescribeTets(const std::filesystem::path& file) {
  const TetMeshFile read = ReadTetMesh(file);
  const TetQuality quality = MeasureTets(read.mesh);
  fmt::print("{}: a tetrahedral mesh of order {}\n", file.string(), read.mesh.Order());
  fmt::print("  nodes {}, tetrahedra {}\n", read.mesh.NodeCount(), quality.tets);
  fmt::print("  size {}, volume {:.6g}\n", InOwnUnit(BoundingBox(read.mesh.nodes)),
             quality.total_volume);
  fmt::print(
      "  radius-edge ratio {:.3f} mean, {:.3f} worst; dihedral angles {:.1f} to {:.1f} deg\n",
      quality.radius_edge_ratio.mean, quality.radius_edge_ratio.max,
      quality.min_dihedral_angle * 180 / std::numbers::pi,
      quality.max_dihedral_angle * 180 / std::numbers::pi);
  for (const std::string& note : read.notes) fmt::print("  note: {}\n", note);
}

void DescribeRun(const std::filesystem::path& folder) {
  const Manifest manifest = ReadManifest(folder / "manifest.json");
  fmt::print("{}: a run, {}\n  by lacuna {}, seed {}, {} input files\n", folder.string(),
             manifest.finished ? "finished" : "not finished (run the same command to resume)",
             manifest.program_version, manifest.seed, manifest.inputs.size());
  for (const auto& [stage, result] : manifest.stages)
    fmt::print("  stage {:10} {} files\n", stage, result.files.size());
  if (!manifest.finished) return;
  for (const auto& [stage, result] : manifest.stages)
    FinishedStage(folder, stage);  // throws where it is damaged
  if (manifest.stages.count("calibration") > 0) {
    const CalibrationRecord fit = ReadCalibration(folder);
    fmt::print("{}", CalibrationReport(fit));
    const std::filesystem::path diagnosis = folder / "diagnosis" / "diagnosis.json";
    if (!std::filesystem::exists(diagnosis)) return;
    const std::string hash = HashFile(FinishedStage(folder, "calibration") / "calibration.json");
    if (IsDiagnosisOf(hash, diagnosis.parent_path()))
      fmt::print("{}", DiagnosisReport(ReadDiagnosisFile(diagnosis), fit, folder));
    else
      fmt::print(
          "\n{} belongs to an earlier fit and is not shown; `lacuna diagnose {}` makes a new one\n",
          diagnosis.string(), folder.string());
    return;
  }
  const RunRecord record = ReadRunRecord(folder / "results");
  fmt::print("  recording {}, {} frames, {} nodes, {} tetrahedra of order {}\n", record.recording,
             record.FrameCount(), record.mesh.node_count, record.mesh.tet_count, record.mesh.order);
  fmt::print("  |D_anim| {}; usable: {}\n",
             std::isnan(record.animation_residual)
                 ? "not measured"
                 : fmt::format("{:.4g} m", record.animation_residual),
             record.IsUsable() ? "yes" : "no");
  for (const auto& [name, value] : record.measures) fmt::print("  {:30} {:.6g}\n", name, value);
  for (const std::string& warning : record.warnings) fmt::print("  warning: {}\n", warning);
}

void ShowRecording(const Recording& recording) {
  constexpr int64_t kMostPoints = 5'000'000;  // what is read within seconds
  fmt::print("{}", DescribeRecording(recording));
  ExaminedRecording examined;
  try {
    examined = ExamineRecording(recording, {}, kMostPoints);
  } catch (const InputError& problem) {
    examined.findings = {problem.what()};
  }
  if (!examined.scatter.empty()) fmt::print("  {:<12} {}\n", "scatter", examined.scatter);
  for (const std::string& finding : examined.findings)
    fmt::print("  {:<12} {}\n", "warning", finding);
}

// Experiments and scenes, which are recognised as `lacuna validate` does.
void RefuseExperiment(const std::filesystem::path& file) {
  const Config config = Config::Load(file);
  const char* kind = config.Has("bar")           ? "a scene"
                     : IsPredictionStudy(config) ? "an experiment for `lacuna fit`"
                     : config.Has("recording")   ? "an experiment for `lacuna reconstruct`"
                                                 : nullptr;
  if (kind == nullptr) return;
  throw InputError(SourcePosition{file.string()},
                   fmt::format("is {0}; `lacuna validate {1} --show` checks it and prints its "
                               "values, `lacuna info` shows recordings, meshes and runs",
                               kind, file.string()));
}

int Info(const std::filesystem::path& path) {
  constexpr std::array kSurfaces{".ply", ".obj", ".stl", ".off"};
  constexpr std::array kTets{".msh", ".node", ".ele", ".mesh", ".tet", ".txt"};
  const std::string extension = path.extension().string();
  const auto is_in = [&](const auto& list) {
    return std::find(list.begin(), list.end(), extension) != list.end();
  };
  if (!std::filesystem::exists(path))
    throw InputError(SourcePosition{path.string()}, "there is no such file or folder");
  if (std::filesystem::exists(path / "manifest.json")) {
    DescribeRun(path);
  } else if (std::filesystem::is_directory(path) || extension == ".yaml") {
    if (!std::filesystem::is_directory(path)) RefuseExperiment(path);
    ShowRecording(LoadRecording(path));
  } else if (is_in(kSurfaces)) {
    DescribeSurface(path);
  } else if (is_in(kTets)) {
    DescribeTets(path);
  } else {
    throw InputError(SourcePosition{path.string()},
                     "is neither a recording, a run nor a mesh of a known format");
  }
  return 0;
}

}  // namespace

void AddInfo(CLI::App* app, std::function<int()>* command) {
  CLI::App* info = app->add_subcommand("info", "Show what a recording, a mesh or a run contains");
  auto path = std::make_shared<std::string>();
  info->add_option("file", *path, "A recording (its folder or recording.yaml), a mesh, or a run")
      ->required();
  info->callback([command, path] { *command = [path] { return Info(*path); }; });
}

}  // namespace lacuna
