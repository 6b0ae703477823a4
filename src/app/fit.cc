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
  if (!record.message.empty()) fmt::print("\nThe fit did not converge: {}\n", record.message);
  fmt::print(
      "\nThe run was written to {}\n"
      "  calibration/calibration.json   parameters with intervals, and errors\n",
      study.output.string());
  if (std::filesystem::exists(study.output / "calibration/misfit.csv"))
    fmt::print(
        "  calibration/misfit.csv         residual of each marker, or surface patch, in each "
        "frame\n");
  return record.usable ? 0 : 1;
}

}  // namespace

void AddFit(CLI::App* app, std::function<int()>* command) {
  CLI::App* fit = app->add_subcommand(
      "fit", "Fit the parameters of a predictive model to recordings, with intervals");
  fit->footer(
      "The experiment names the recordings, the model and its unknown parameters;\n"
      "experiments/silicone_beam.yaml is an example. Held-out frames and recordings are predicted\n"
      "and compared, never fitted. The same command resumes an interrupted run at its stage.");
  auto file = std::make_shared<std::string>();
  fit->add_option("experiment", *file, "The experiment's YAML file")->required();
  fit->callback([command, file] { *command = [file] { return Fit(*file); }; });
}

}  // namespace lacuna
