// lacuna compare RUN
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>

#include "app/commands.h"
#include "comparison/compared_motion.h"
#include "comparison/comparison_files.h"
#include "comparison/run_comparison.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/progress.h"
#include "core/text_layout.h"
#include "record/run_directory.h"
#include "report/comparison_report.h"
#include "report/headline.h"
#include "report/reported_run.h"

namespace lacuna {
namespace {

struct CompareArguments {
  std::string run;
  bool files_only = false, stored = false;
};

void PrintReport(const ComparisonRecord& record, bool all) {
  fmt::print("\n{}", ComparisonTable(record));
  if (!all) return;
  for (const std::string& paragraph : DescribeComparison(record))
    fmt::print("\n{}", Wrapped(paragraph, "", ""));
  for (const std::string& note : record.notes) fmt::print("\n{}", Wrapped(note, "", ""));
}

void PrintFiles(const ComparisonRecord& record, const std::string& run) {
  fmt::print(
      "\nFiles in {}/comparison:\n"
      "  comparison.json        all results, and the text above\n"
      "  by_frame.csv           the error of each frame\n"
      "  by_marker.csv          the error of each marker\n"
      "  by_quantity.csv        the error as a function of time, displacement, speed and others\n",
      run);
  if (std::any_of(record.recordings.begin(), record.recordings.end(),
                  [](const auto& recording) { return recording.force && recording.force->usable; }))
    fmt::print("  unexplained_force.csv  net force, torque, power and position over time\n");
  for (size_t r = 0; r < record.recordings.size(); ++r) {
    const ComparedRecording& recording = record.recordings[r];
    if (recording.field_frames == 0) continue;
    fmt::print("  {0}/body.pvd, {0}/{1}.pvd   {2} frames of {3} for ParaView\n", r,
               recording.is_scan ? "patches" : "markers", recording.field_frames, recording.name);
  }
}

// The comparison that the run holds. Throws InputError where there is none of its fit.
ComparisonRecord StoredComparison(const std::filesystem::path& run) {
  const std::filesystem::path file = run / "comparison/comparison.json";
  if (!std::filesystem::exists(file))
    throw InputError({file.string()}, "there is no such file; `lacuna compare` writes it");
  ComparisonRecord stored = ReadComparisonFile(file);
  if (!IsComparisonOf(HashFile(FinishedStage(run, "calibration") / "calibration.json"), file))
    throw InputError({file.string()},
                     fmt::format("belongs to an earlier fit; `lacuna compare {}` makes a new one",
                                 run.string()));
  return stored;
}

int Compare(const CompareArguments& arguments, const OutputOptions& output) {
  const std::filesystem::path folder = std::filesystem::path(arguments.run) / "comparison";
  if (arguments.stored) {
    const ComparisonRecord stored = StoredComparison(arguments.run);
    if (output.json) PrintRecord(folder / "comparison.json");
    if (output.PrintsText()) PrintReport(stored, output.verbose);
    return 0;
  }
  Comparison comparison = CompareRun(arguments.run);
  // Fields that an earlier comparison wrote may belong to another fit.
  for (size_t r = 0; r < comparison.residuals.size(); ++r)
    std::filesystem::remove_all(folder / std::to_string(r));
  Progress progress(output.ForProgress());
  if (!arguments.files_only) CompareMotion(arguments.run, &progress, &comparison);
  WriteComparison(comparison, arguments.run);
  if (output.json) PrintRecord(folder / "comparison.json");
  if (output.PrintsText()) {
    PrintReport(comparison.record, output.verbose);
    if (output.verbose) PrintFiles(comparison.record, arguments.run);
  }
  PrintSentences(output, Headline(OpenReportedRun(arguments.run).models));
  WriteRunReport(output, arguments.run);
  return 0;
}

}  // namespace

void AddCompare(CLI::App* app, OutputOptions* output, std::function<int()>* command) {
  CLI::App* compare = app->add_subcommand(
      "compare", "Show where, when and by how much a fitted model fails to predict its recordings");
  compare->footer(
      "RUN is the folder of a finished `lacuna fit`. Fitted and held-out frames are reported\n"
      "separately; docs/prediction.md explains the terms. The model is run again to compute "
      "strain,\n"
      "height, fields for ParaView and the force that would make it follow the recording.");
  auto arguments = std::make_shared<CompareArguments>();
  compare->add_option("run", arguments->run, "Folder of the run, results/NAME")->required();
  CLI::Option* files_only = compare->add_flag(
      "--files-only", arguments->files_only,
      "Do not run the model again: no strain, height, fields or unexplained force");
  compare
      ->add_flag("--stored", arguments->stored,
                 "Print the comparison that RUN already holds, without computing anything")
      ->excludes(files_only);
  AddOutputOptions(compare, output);
  compare->callback([=] { *command = [=] { return Compare(*arguments, *output); }; });
}

}  // namespace lacuna
