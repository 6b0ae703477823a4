// lacuna ablation [FOLDER]
#include "paper/ablation.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"
#include "app/table1_arguments.h"

namespace lacuna {
namespace {

int RunAblation(const Table1Arguments& arguments) {
  const Table1Study study = ReadTable1(arguments.folder);
  CheckAblation(study);
  const Table1Options& options = arguments.options;
  Progress progress;
  const Table1Result result = RunTable1(study, options, &progress);
  WriteAblation(study, result, options.output);
  fmt::print("{}\nThe table was written to {}: ablation.txt, ablation.json and ablation.csv\n",
             AblationText(study, result), options.output.string());
  return ExitCode(result);
}

}  // namespace

void AddAblation(CLI::App* app, std::function<int()>* command) {
  CLI::App* ablation = app->add_subcommand(
      "ablation",
      "Repeat the outer search with one setting changed at a time, and report the effect of each");
  ablation->footer(
      "Each .yaml file in the folder is a row of the table (docs/search.md). An interrupted run\n"
      "continues at the evaluation where it stopped.");
  auto arguments = std::make_shared<Table1Arguments>();
  arguments->folder = "experiments/ablation";
  Table1Options& options = arguments->options;
  options.output = "results/ablation";
  options.turns = 4;
  options.profile = false;
  options.in_loop = false;
  options.difference_steps = {0.2, 0.1, 0.05, 0.02, 0.01, 0.005};
  AddTable1Arguments(ablation, arguments.get());
  ablation->callback(
      [command, arguments] { *command = [arguments] { return RunAblation(*arguments); }; });
}

}  // namespace lacuna
