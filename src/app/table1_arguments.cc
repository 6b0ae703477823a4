#include "app/table1_arguments.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>

namespace lacuna {

void AddTable1Arguments(CLI::App* command, Table1Arguments* arguments) {
  Table1Options& options = arguments->options;
  command->add_option("folder", arguments->folder,
                      fmt::format("Folder of the experiment files ({})", arguments->folder));
  command->add_option("-o,--output", options.output,
                      fmt::format("Folder of the results ({})", options.output.string()));
  command
      ->add_option("--seeds", options.seeds,
                   "Number of repetitions of the searches, each with different scans, starting "
                   "points and meshes")
      ->check(CLI::Range(1, 1000));
  command
      ->add_option("--turns", options.turns,
                   "Number of meshes from which to estimate the mesh noise")
      ->check(CLI::Range(0, 1000));
}

int ExitCode(const Table1Result& result) {
  for (const Table1Seed& seed : result.seeds)
    for (const Table1Search& search : seed.searches)
      if (!search.found.IsUsable()) return 1;
  return 0;
}

}  // namespace lacuna
