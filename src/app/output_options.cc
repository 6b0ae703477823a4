#include "app/output_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

#include "calibration/kept_motion.h"
#include "core/text_file.h"
#include "core/text_layout.h"
#include "report/headline.h"
#include "report/report_page.h"
#include "report/reported_run.h"

namespace lacuna {

ProgressOptions OutputOptions::ForProgress() const {
  ProgressOptions options;
  if (quiet) options.style = ProgressStyle::kSilent;
  return options;
}

void AddPrintOptions(CLI::App* command, OutputOptions* output) {
  CLI::Option* verbose = command->add_flag("-v,--verbose", output->verbose,
                                           "Print the whole result, and log the stages in detail");
  CLI::Option* json = command->add_flag("--json", output->json,
                                        "Print the record of the result as JSON, and nothing else");
  command->add_flag("-q,--quiet", output->quiet, "Print nothing but errors")
      ->excludes(verbose)
      ->excludes(json);
  json->excludes(verbose);
}

void AddOutputOptions(CLI::App* command, OutputOptions* output) {
  AddPrintOptions(command, output);
  command->add_flag_callback(
      "--no-report", [output] { output->report = false; }, "Do not write the HTML report");
}

void PrintWarnings(const OutputOptions& output, const std::vector<std::string>& warnings) {
  if (output.quiet) return;
  for (const std::string& warning : warnings) fmt::print(stderr, "warning: {}\n", warning);
}

void PrintRecord(const std::filesystem::path& file) { fmt::print("{}", ReadWholeFile(file)); }

void PrintSentences(const OutputOptions& output, const std::vector<std::string>& sentences) {
  if (!output.PrintsText() || output.verbose) return;
  fmt::print("\n");
  for (const std::string& sentence : sentences) fmt::print("{}", Wrapped(sentence, "", ""));
}

void WriteRunReport(const OutputOptions& output, const std::filesystem::path& run) {
  if (!output.report) return;
  const ReportFiles files = DefaultReportFiles({run});
  WriteReport({run}, files);
  if (output.PrintsText())
    fmt::print("\nThe report, to open in a browser: {}\n", files.page.string());
}

void WriteFitReport(const OutputOptions& output, const std::filesystem::path& run,
                    Progress* progress) {
  const ReportedRun opened = OpenReportedRun(run);
  PrintSentences(output, Headline(opened.models));
  if (!output.report) return;
  for (const ReportedModel& model : opened.models)
    if (model.calibration.usable) KeepMotion(model.folder, progress);
  WriteRunReport(output, run);
}

}  // namespace lacuna
