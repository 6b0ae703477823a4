// lacuna table1 [FOLDER]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"
#include "app/table1_arguments.h"
#include "paper/table1_report.h"

namespace lacuna {
namespace {

int RunTable(const Table1Arguments& arguments, const OutputOptions& output) {
  const Table1Study study = ReadTable1(arguments.folder);
  const Table1Options& options = arguments.options;
  Progress progress(output.ForProgress());
  const Table1Result result = RunTable1(study, options, &progress);
  WriteTable1(study, result, options.output);
  if (output.json) PrintRecord(options.output / "table1.json");
  if (output.PrintsText())
    fmt::print(
        "{}\nThe table was written to {}: table1.txt, table1.json, traces.svg, one .csv per "
        "search\n",
        output.verbose ? Table1Text(study, result) : Table1ClaimsText(study, result),
        options.output.string());
  WriteRunReport(output, options.output);
  return ExitCode(result);
}

}  // namespace

void AddTable1(CLI::App* app, OutputOptions* output, std::function<int()>* command) {
  CLI::App* table = app->add_subcommand(
      "table1",
      "Repeat the paper's Table 1: search (q, v), (y, p) and all four, and check its claims");
  table->footer(
      "Each .yaml file in the folder is a row of the table: a reconstruction without a recording,\n"
      "the scene that makes one, and a search (docs/search.md). An interrupted run continues at\n"
      "the evaluation where it stopped.");
  auto arguments = std::make_shared<Table1Arguments>();
  arguments->folder = "experiments/table1";
  AddTable1Arguments(table, arguments.get());
  AddOutputOptions(table, output);
  table->callback([=] { *command = [=] { return RunTable(*arguments, *output); }; });
}

}  // namespace lacuna
