// lacuna validate FILE
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "calibration/calibration_problem.h"
#include "experiment/model_reader.h"
#include "experiment/reference_body.h"
#include "experiment/scatter_findings.h"
#include "experiment/scene.h"
#include "prediction/predicted_body.h"
#include "prediction/prediction_study.h"
#include "prediction/prediction_study_reader.h"
#include "prediction/recorded_motion.h"
#include "reconstruction/reconstruction_study.h"
#include "scan/recording.h"

namespace lacuna {
namespace {

// An experiment is checked within seconds; the frames of its recordings are examined up to here.
constexpr int64_t kMostPoints = 5'000'000;

void PrintWarnings(const std::vector<std::string>& warnings, const std::string& of = "") {
  for (const std::string& warning : warnings) {
    if (!warning.empty()) fmt::print("warning: {}{}\n", of, warning);
  }
}

void PrintExamined(const ExaminedRecording& examined, const std::string& of = "") {
  PrintWarnings(examined.findings, of);
  if (!examined.scatter.empty()) fmt::print("scatter: {}{}\n", of, examined.scatter);
}

StatedNoise NoiseOf(const PredictionStudy& study, const PredictedRecording& item) {
  if (item.ShowsScans()) return {study.scan.noise, "scan.noise", study.scan.filter.voxel_size};
  return {study.noise_is_estimated ? 0 : study.noise, "noise"};
}

void PrintUse(const PredictedRecording& item) {
  const size_t fitted = item.FittedFrames().size();
  fmt::print("frames: {}: {} are fitted, {} are held out\n", item.name, fitted,
             item.frames.size() - fitted);
}

int Validate(const std::filesystem::path& path, bool show) {
  nlohmann::json resolved;
  if (std::filesystem::is_directory(path) || path.filename() == "recording.yaml") {
    const Recording recording = LoadRecording(path);
    PrintWarnings(recording.warnings);
    PrintExamined(ExamineRecording(recording));
    fmt::print("{}: a valid recording of {} frames\n", path.string(), recording.FrameCount());
    resolved = nlohmann::json::parse(recording.resolved);
  } else {
    const Config config = Config::Load(path);
    if (config.Has("bar")) {
      PrintWarnings({AuxeticWarning(ReadScene(config).effects)});
      fmt::print("{}: a valid scene\n", path.string());
    } else if (IsPredictionStudy(config)) {
      const PredictionStudy study = ReadPredictionStudy(config);
      PrintWarnings(StudyWarnings(study));
      for (const PredictedRecording& item : study.recordings)
        PrintExamined(ExamineRecording(item.recording, NoiseOf(study, item), kMostPoints),
                      item.name + ": ");
      for (const PredictedRecording& item : study.recordings) PrintUse(item);
      if (study.density != study.recordings.front().recording.object.density)
        PrintWarnings({DoubtOfDensity(study.density)});
      const ReferenceBody body = MakeReferenceBody(study);
      PrintWarnings(body.notes, "the mesh: ");
      const CalibrationProblem problem(study, body.mesh);  // checks the recordings on that mesh
      fmt::print(
          "{}: a valid experiment for `lacuna fit` on {} recording{}, {} nodes and {} unknown{}\n",
          path.string(), study.recordings.size(), study.recordings.size() == 1 ? "" : "s",
          body.mesh.NodeCount(), problem.parameters().size(),
          problem.parameters().size() == 1 ? "" : "s");
    } else {
      const ReconstructionStudy study = ReadReconstruction(config);
      PrintWarnings(study.recording.warnings);
      PrintExamined(ExamineRecording(study.recording,
                                     {study.follow.noise, "fit.noise", study.filter.voxel_size},
                                     kMostPoints));
      if (study.density != study.recording.object.density)
        PrintWarnings({DoubtOfDensity(study.density)});
      fmt::print("{}: a valid experiment on {} frames of \"{}\"\n", path.string(),
                 study.frames.size(), study.recording.name);
    }
    resolved = config.Resolved();
  }
  if (show) fmt::print("{}\n", resolved.dump(2));
  return 0;
}

}  // namespace

void AddValidate(CLI::App* app, std::function<int()>* command) {
  CLI::App* validate = app->add_subcommand(
      "validate", "Check an experiment, a scene or a recording, as `fit` does before it starts");
  auto path = std::make_shared<std::string>();
  auto show = std::make_shared<bool>(false);
  validate->add_option("file", *path, "The YAML file, or a recording's folder")->required();
  validate->add_flag("--show", *show, "Print every value, defaults included, in SI units");
  validate->callback(
      [command, path, show] { *command = [path, show] { return Validate(*path, *show); }; });
}

}  // namespace lacuna
