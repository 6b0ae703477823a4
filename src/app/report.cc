// lacuna report RUN [RUN...]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/commands.h"
#include "core/text_file.h"
#include "core/text_layout.h"
#include "report/report_page.h"

namespace lacuna {
namespace {

struct ReportArguments {
  std::vector<std::string> runs;
  std::string output;
};

int Report(const ReportArguments& arguments, const OutputOptions& output) {
  const std::vector<std::filesystem::path> runs(arguments.runs.begin(), arguments.runs.end());
  const ReportFiles files =
      arguments.output.empty() ? DefaultReportFiles(runs) : FilesOf(arguments.output);
  const nlohmann::json document = WriteReport(runs, files);
  if (output.json) fmt::print("{}", ReadWholeFile(files.numbers));
  if (!output.PrintsText()) return 0;
  for (const auto& sentence : document.at("sentences"))
    fmt::print("{}", Wrapped(sentence.get<std::string>(), "", ""));
  fmt::print("\nThe report, to open in a browser: {}\nIts numbers: {}\n", files.page.string(),
             files.numbers.string());
  return 0;
}

}  // namespace

void AddReport(CLI::App* app, OutputOptions* output, std::function<int()>* command) {
  CLI::App* report = app->add_subcommand(
      "report", "Write the results of a run as one HTML page, with the motion in 3D");
  report->footer(
      "RUN is the folder of a finished `lacuna fit`, `reconstruct`, `table1` or `ablation`, or of\n"
      "`lacuna-trials report` or `intervals`. The page needs nothing but a browser, and no\n"
      "network. Nothing is computed again; `compare` and `diagnose` add to what it shows. Several\n"
      "runs are shown side by side, if their errors refer to the same frames of the same\n"
      "recordings. docs/report.md explains the page.");
  auto arguments = std::make_shared<ReportArguments>();
  report->add_option("run", arguments->runs, "Folders of the runs")->required();
  report->add_option("-o,--output", arguments->output,
                     "The file to write (default: RUN/report.html; for several runs "
                     "A_vs_B.html, beside A)");
  report->add_flag("--json", output->json, "Print the numbers as JSON, and nothing else");
  report->add_flag("-q,--quiet", output->quiet, "Print nothing but errors");
  report->callback([=] { *command = [=] { return Report(*arguments, *output); }; });
}

}  // namespace lacuna
