// lacuna table1 [FOLDER]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"
#include "study/table1_report.h"

namespace lacuna {
namespace {

struct Arguments {
  std::string folder = "experiments/table1";
  std::string output = "results/table1";
  int seeds = 1;
  int turns = 8;
};

int RunTable(const Arguments& arguments) {
  const Table1Study study = ReadTable1(arguments.folder);
  Table1Options options;
  options.output = arguments.output;
  options.seeds = arguments.seeds;
  options.turns = arguments.turns;
  Progress progress;
  const Table1Result result = RunTable1(study, options, &progress);
  WriteTable1(study, result, options.output);
  fmt::print("{}\nThe table lies in {}: table1.txt, table1.json, traces.svg and a .csv a search\n",
             Table1Text(study, result), arguments.output);
  for (const Table1Seed& seed : result.seeds)
    for (const Table1Search& search : seed.searches)
      if (!search.found.IsUsable()) return 1;
  return 0;
}

}  // namespace

void AddTable1(CLI::App* app, std::function<int()>* command) {
  CLI::App* table = app->add_subcommand(
      "table1", "The paper's Table 1: search (q, v), (y, p) and all four, and say what holds");
  table->footer(
      "Each .yaml file in the folder is a row: a reconstruction without recording, the scene that\n"
      "makes one, and a search (docs/search.md). Stopped at any evaluation, it goes on from "
      "there.");
  auto arguments = std::make_shared<Arguments>();
  table->add_option("folder", arguments->folder, "The experiment files (experiments/table1)");
  table->add_option("-o,--output", arguments->output, "Folder of the results (results/table1)");
  table
      ->add_option("--seeds", arguments->seeds,
                   "Scans, starts and meshes to repeat the searches with")
      ->check(CLI::Range(1, 1000));
  table->add_option("--turns", arguments->turns, "Meshes from which to tell the mesh noise")
      ->check(CLI::Range(0, 1000));
  table->callback(
      [command, arguments] { *command = [arguments] { return RunTable(*arguments); }; });
}

}  // namespace lacuna
