// lacuna-faults: disturbs the commands of Lacuna and looks whether they survive (docs/faults.md).
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <exception>
#include <fstream>

#include "faults/faults.h"

int main(int argc, char** argv) {
  lacuna::FaultOptions options;
  options.sources = LACUNA_SOURCE_DIR;
  options.kills = 200;
  options.damaged_files = 1000;
  options.full_disks = 1000;
  options.faketime = lacuna::FindFaketime();
  std::vector<std::string> commands;
  CLI::App app{"Disturbs the commands of Lacuna and looks whether they survive.", "lacuna-faults"};
  app.add_option("program", options.program, "The program lacuna")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("folder", options.folder, "Folder of the runs; a second start continues there")
      ->required();
  app.add_option("--kills", options.kills, "How often each command is killed")
      ->capture_default_str();
  app.add_option("--damaged-files", options.damaged_files,
                 "How many files of each stage are damaged, each in two ways")
      ->capture_default_str();
  app.add_option("--full-disks", options.full_disks, "How many sizes of a small disk are tried")
      ->capture_default_str();
  app.add_option("--faketime", options.faketime,
                 "The library libfaketimeMT.so.1; default: that of the package faketime")
      ->check(CLI::ExistingFile);
  app.add_option("--seed", options.seed, "Seed of the random moments")->capture_default_str();
  std::vector<std::string> names;
  for (const lacuna::Subject& subject : lacuna::BundledSubjects()) names.push_back(subject.name);
  app.add_option("--command", commands, "Only these")->check(CLI::IsMember(names));
  CLI11_PARSE(app, argc, argv);
  try {
    options.program = std::filesystem::absolute(options.program);
    std::vector<lacuna::FaultResult> all;
    for (const lacuna::Subject& subject : lacuna::BundledSubjects()) {
      if (!commands.empty() && std::count(commands.begin(), commands.end(), subject.name) == 0)
        continue;
      const auto report = [](const lacuna::FaultResult& one) {
        fmt::print(stderr, "{}, {}: {} of {} {}\n", one.fault, one.subject, one.survived,
                   one.trials, one.note);
      };
      for (lacuna::FaultResult& one : lacuna::TryFaults(subject, options, report))
        all.push_back(std::move(one));
    }
    const std::string table = lacuna::FaultTable(all);
    std::ofstream(options.folder / "faults.md") << table;
    fmt::print("{}", table);
    return std::all_of(all.begin(), all.end(),
                       [](const auto& one) { return one.survived == one.trials; })
               ? 0
               : 1;
  } catch (const std::exception& error) {
    fmt::print(stderr, "lacuna-faults: {}\n", error.what());
    return 1;
  }
}
