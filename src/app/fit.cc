// lacuna fit EXPERIMENT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "app/commands.h"
#include "calibration/calibration_run.h"
#include "prediction/prediction_study_reader.h"
#include "prediction/recorded_motion.h"
#include "report/calibration_report.h"

namespace lacuna {
namespace {

int Fit(const std::string& file) {
  const PredictionStudy study = ReadPredictionStudy(Config::Load(file));
  for (const std::string& warning : StudyWarnings(study))
    fmt::print(stderr, "warning: {}\n", warning);
  Progress progress;
  const CalibrationRecord record = RunCalibration(study, &progress);
  fmt::print("{}", CalibrationReport(record));
  if (!record.usable) fmt::print("\nThe fit did not converge: {}\n", record.message);
  fmt::print(
      "\nThe run lies in {}\n"
      "  calibration/calibration.json   parameters with intervals, errors\n",
      study.output.string());
  if (std::filesystem::exists(study.output / "calibration/misfit.csv"))
    fmt::print(
        "  calibration/misfit.csv         each marker, or patch of a surface, of each frame\n");
  return record.usable ? 0 : 1;
}

}  // namespace

void AddFit(CLI::App* app, std::function<int()>* command) {
  CLI::App* fit =
      app->add_subcommand("fit", "Fit a model that predicts to recordings, with intervals");
  fit->footer(
      "The experiment names recordings, the model and which of its parameters are unknown;\n"
      "experiments/silicone_beam.yaml is one. Frames and recordings that are held out are "
      "predicted\n"
      "and compared, never fitted. Run again, it resumes by stage.");
  auto file = std::make_shared<std::string>();
  fit->add_option("experiment", *file, "The experiment's YAML file")->required();
  fit->callback([command, file] { *command = [file] { return Fit(*file); }; });
}

}  // namespace lacuna
