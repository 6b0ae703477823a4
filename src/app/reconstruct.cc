// lacuna reconstruct EXPERIMENT
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <memory>

#include "app/commands.h"
#include "reconstruction/reconstruction.h"
#include "reconstruction/reconstruction_study.h"
#include "report/reconstruction_headline.h"

namespace lacuna {
namespace {

std::string Length(double metres) {
  return std::isnan(metres) ? "-" : fmt::format("{:.3f} mm", 1e3 * metres);
}

// A number of metres with four digits.
std::string Metres(double metres) {
  return std::isnan(metres) ? "-" : fmt::format("{:.4g}", metres);
}

// |D_anim|, and its mean per point in mm if `with_mean` and relative to the object's size.
std::string AnimationResiduals(const RunRecord& record, bool with_mean) {
  if (std::isnan(record.relative_animation_residual)) return "|D_anim| (Eq. 2)  not measured";
  const std::string sum = std::isnan(record.animation_residual)
                              ? "not measured in some frames; over the others"
                              : Metres(record.animation_residual) + " m,";
  const std::string mean =
      with_mean ? fmt::format(" {} per point and frame,",
                              Length(record.relative_animation_residual * record.object_size))
                : "";
  return fmt::format("|D_anim| (Eq. 2)  {}{} {:.3f} % of the object's size", sum, mean,
                     100 * record.relative_animation_residual);
}

void PrintFrames(const RunRecord& record) {
  fmt::print(
      "\n  frame    time s   |D| m      |D| per point   scan to surface: mean   max"
      "         force N (sd)        factors  fit\n");
  for (const FrameRecord& frame : record.frames) {
    const double deviation = frame.force_resultant_deviation.norm();
    const std::string force =
        fmt::format("{:.3g}{}", frame.force_resultant.norm(),
                    std::isnan(deviation) ? "" : fmt::format(" ({:.2g})", deviation));
    fmt::print("  {:5} {:9.3f}   {:<9}  {:>13}   {:>21} {:>9}   {:>17}   {:>7}  {}\n", frame.frame,
               frame.time, Metres(frame.residual), Length(frame.residual_mean),
               Length(frame.surface_distance_mean), Length(frame.surface_distance_max), force,
               frame.solver.iterations, frame.solver.status);
  }
}

void PrintSummary(const RunRecord& record, const std::filesystem::path& output) {
  fmt::print("\n{}\n", AnimationResiduals(record, /*with_mean=*/true));
  for (const auto& [name, value] : record.measures) fmt::print("{:32} {:.6g}\n", name, value);
  for (const std::string& warning : record.warnings) fmt::print("warning: {}\n", warning);
  fmt::print(
      "\nThe run was written to {}\n"
      "  results/record.json, frames.csv         the numbers\n"
      "  results/last_frame.png                   the model and the scan\n"
      "  results/body.pvd, surface.pvd, scan.pvd  open in ParaView\n"
      "  manifest.json                            what was run, on which inputs\n",
      output.string());
}

void PrintShortSummary(const RunRecord& record, const std::filesystem::path& output) {
  fmt::print("\n{}; {} frames\n", AnimationResiduals(record, /*with_mean=*/false),
             record.FrameCount());
  for (const std::string& warning : record.warnings) fmt::print("warning: {}\n", warning);
  fmt::print("The run was written to {}\n", output.string());
}

int Reconstruct(const std::string& file, const OutputOptions& output) {
  const ReconstructionStudy study = ReadReconstruction(Config::Load(file));
  PrintWarnings(output, study.recording.warnings);
  Progress progress(output.ForProgress());
  const RunRecord record = RunReconstruction(study, &progress);
  if (output.json) PrintRecord(study.output / "results/record.json");
  if (output.PrintsText() && output.verbose) {
    PrintFrames(record);
    PrintSummary(record, study.output);
  }
  if (output.PrintsText() && !output.verbose) PrintShortSummary(record, study.output);
  PrintSentences(output, ReconstructionHeadline(record));
  WriteRunReport(output, study.output);
  return record.IsUsable() ? 0 : 1;
}

}  // namespace

void AddReconstruct(CLI::App* app, OutputOptions* output, std::function<int()>* command) {
  CLI::App* reconstruct = app->add_subcommand(
      "reconstruct", "Reconstruct a moving model with per-step forces from a recording");
  reconstruct->footer(
      "The experiment file names a recording, the mesh settings, the material and the forces;\n"
      "experiments/bend.yaml is an example with comments. The same command resumes an interrupted\n"
      "run at its stage. Progress is written to standard error: one line that is updated in place\n"
      "on a terminal, JSON lines elsewhere.");
  auto file = std::make_shared<std::string>();
  reconstruct->add_option("experiment", *file, "The experiment's YAML file")->required();
  AddOutputOptions(reconstruct, output);
  reconstruct->callback([=] { *command = [=] { return Reconstruct(*file, *output); }; });
}

}  // namespace lacuna
