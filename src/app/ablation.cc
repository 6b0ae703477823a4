// lacuna ablation [FOLDER]
#include "study/ablation.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"

namespace lacuna {
namespace {

struct Arguments {
  std::string folder = "experiments/ablation";
  std::string output = "results/ablation";
  int seeds = 1;
  int turns = 4;
};

int RunAblation(const Arguments& arguments) {
  const Table1Study study = ReadTable1(arguments.folder);
  CheckAblation(study);
  Table1Options options;
  options.output = arguments.output;
  options.seeds = arguments.seeds;
  options.turns = arguments.turns;
  options.profile = false;
  options.in_loop = false;
  options.difference_steps = {0.2, 0.1, 0.05, 0.02, 0.01, 0.005};
  Progress progress;
  const Table1Result result = RunTable1(study, options, &progress);
  WriteAblation(study, result, options.output);
  fmt::print("{}\nThe table lies in {}: ablation.txt, ablation.json and ablation.csv\n",
             AblationText(study, result), arguments.output);
  for (const Table1Seed& seed : result.seeds)
    for (const Table1Search& search : seed.searches)
      if (!search.found.IsUsable()) return 1;
  return 0;
}

}  // namespace

void AddAblation(CLI::App* app, std::function<int()>* command) {
  CLI::App* ablation = app->add_subcommand(
      "ablation", "The outer search with one thing changed at a time, and what each change does");
  ablation->footer(
      "Each .yaml file in the folder is a row (docs/search.md). Stopped at any evaluation, it "
      "goes\n"
      "on from there.");
  auto arguments = std::make_shared<Arguments>();
  ablation->add_option("folder", arguments->folder, "The experiment files (experiments/ablation)");
  ablation->add_option("-o,--output", arguments->output,
                       "Folder of the results (results/ablation)");
  ablation
      ->add_option("--seeds", arguments->seeds,
                   "Scans, starts and meshes to repeat the searches with")
      ->check(CLI::Range(1, 1000));
  ablation->add_option("--turns", arguments->turns, "Meshes from which to tell the mesh noise")
      ->check(CLI::Range(0, 1000));
  ablation->callback(
      [command, arguments] { *command = [arguments] { return RunAblation(*arguments); }; });
}

}  // namespace lacuna
