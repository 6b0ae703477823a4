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

void PrintFit(const CalibrationRecord& record, const std::filesystem::path& run, bool all) {
  fmt::print("{}", all ? CalibrationReport(record) : CalibrationSummary(record));
  if (!record.message.empty()) fmt::print("\nThe fit did not converge: {}\n", record.message);
  fmt::print("\nThe run was written to {}\n", run.string());
  if (!all) return;
  fmt::print("  calibration/calibration.json   parameters with intervals, and errors\n");
  if (std::filesystem::exists(run / "calibration/misfit.csv"))
    fmt::print(
        "  calibration/misfit.csv         residual of each marker, or surface patch, in each "
        "frame\n");
}

int Fit(const std::string& file, const OutputOptions& output) {
  const PredictionStudy study = ReadPredictionStudy(Config::Load(file));
  PrintWarnings(output, StudyWarnings(study));
  Progress progress(output.ForProgress());
  const CalibrationRecord record = RunCalibration(study, &progress);
  if (output.json) PrintRecord(study.output / "calibration/calibration.json");
  if (output.PrintsText()) PrintFit(record, study.output, output.verbose);
  WriteFitReport(output, study.output, &progress);
  return record.usable ? 0 : 1;
}

}  // namespace

void AddFit(CLI::App* app, OutputOptions* output, std::function<int()>* command) {
  CLI::App* fit = app->add_subcommand(
      "fit", "Fit the parameters of a predictive model to recordings, with intervals");
  fit->footer(
      "The experiment names the recordings, the model and its unknown parameters;\n"
      "experiments/silicone_beam.yaml is an example. Held-out frames and recordings are predicted\n"
      "and compared, never fitted. The same command resumes an interrupted run at its stage.");
  auto file = std::make_shared<std::string>();
  fit->add_option("experiment", *file, "The experiment's YAML file")->required();
  AddOutputOptions(fit, output);
  fit->callback([=] { *command = [=] { return Fit(*file, *output); }; });
}

}  // namespace lacuna
