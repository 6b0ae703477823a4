// lacuna fit EXPERIMENT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "app/commands.h"
#include "study/calibration_run.h"

namespace lacuna {
namespace {

void PrintParameters(const CalibrationRecord& record) {
  fmt::print("\n  {:34} {:>12} {:>25}  {}\n", "parameter", "value", "95 % interval", "");
  for (const FittedParameter& parameter : record.parameters) {
    const ParameterEstimate& estimate = parameter.estimate;
    std::string note = VerdictName(estimate.verdict);
    if (estimate.verdict == ParameterEstimate::Verdict::kPinnedDown) note.clear();
    if (estimate.verdict == ParameterEstimate::Verdict::kTradedOff)
      note +=
          fmt::format(" with {} (correlation {:.2f})", estimate.traded_with, estimate.correlation);
    fmt::print("  {:34} {:>12.4g} {:>12.4g} … {:<10.4g}  {:6} {}\n", parameter.name, estimate.value,
               estimate.low, estimate.high, parameter.unit, note);
  }
}

std::string Describe(const MisfitMeasure& measure) {
  if (measure.points == 0) return "-";
  return fmt::format("{:.3f} mm (largest {:.3f}), {:.1f} σ, {} frames", 1e3 * measure.rms,
                     1e3 * measure.largest, measure.in_noise, measure.frames);
}

int Fit(const std::string& file) {
  const PredictionStudy study = ReadPredictionStudy(Config::Load(file));
  for (const PredictedRecording& item : study.recordings)
    for (const std::string& warning : item.recording.warnings)
      fmt::print(stderr, "warning: {}: {}\n", item.name, warning);
  Progress progress;
  const CalibrationRecord record = RunCalibration(study, &progress);
  PrintParameters(record);
  fmt::print("\n  rms distance of predicted from measured markers; σ = {:.3f} mm of a coordinate\n",
             1e3 * record.noise);
  for (const FittedRecording& recording : record.recordings) {
    fmt::print("  {:14} fitted    {}\n", recording.name, Describe(recording.in_fit));
    fmt::print("  {:14} held out  {}\n", "", Describe(recording.held_out));
  }
  if (!record.usable) fmt::print("\nThe fit did not converge: {}\n", record.message);
  fmt::print(
      "\nThe run lies in {}\n"
      "  calibration/calibration.json   parameters with intervals, errors\n"
      "  calibration/misfit.csv         each marker of each frame\n",
      study.output.string());
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
