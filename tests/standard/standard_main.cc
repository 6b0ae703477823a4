// lacuna-standard: solves the standard problems and prints their table.
#include <fmt/format.h>
#include <glog/logging.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <iostream>
#include <string>
#include <vector>

#include "core/atomic_file.h"
#include "core/error.h"
#include "standard/verification_table.h"

namespace lacuna {
namespace {

std::vector<std::filesystem::path> ProblemFiles(const std::vector<std::string>& names) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry :
       std::filesystem::directory_iterator(LACUNA_SOURCE_DIR "/tests/standard/problems"))
    if (names.empty() ||
        std::find(names.begin(), names.end(), entry.path().stem().string()) != names.end())
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  if (files.size() < names.size())
    throw InputError("there is no such problem in tests/standard/problems");
  return files;
}

int Run(int argc, char** argv) {
  CLI::App app{"Solves standard problems of the finite-element method and prints the errors."};
  std::vector<std::string> names;
  std::string table;
  bool quick = false;
  app.add_option("problems", names, "Names of files in tests/standard/problems; default: all");
  app.add_option("--table", table, "Write the table to this file instead of the terminal");
  app.add_flag("--quick", quick, "Only the meshes that are tested in each build");
  CLI11_PARSE(app, argc, argv);
  std::vector<SolvedProblem> solved;
  for (const std::filesystem::path& file : ProblemFiles(names)) {
    const Problem problem = ReadProblem(file);
    if (!problem.missing_data.empty()) {
      if (!table.empty())
        throw InputError({problem.missing_data.string()},
                         "is absent, so that the table would lack " + problem.name);
      std::cerr << fmt::format("{}: skipped, {} is absent; LACUNA_DATA names the folder of data\n",
                               problem.name, problem.missing_data.string());
      continue;
    }
    SolvedProblem& entry = solved.emplace_back(SolvedProblem{problem, {}});
    const int count = quick ? problem.quick : static_cast<int>(problem.meshes.size());
    double seconds = 0;
    for (const int order : problem.orders) {
      entry.studies.push_back(Refine(problem, order, count));
      for (const ProblemSolution& solution : entry.studies.back().solutions)
        seconds += solution.seconds;
    }
    std::cerr << fmt::format("{}: {:.1f} s\n", problem.name, seconds);
  }
  const std::string text = VerificationTable(solved);
  if (table.empty())
    std::cout << text;
  else
    WriteFileAtomically(table, text);
  return 0;
}

}  // namespace
}  // namespace lacuna

int main(int argc, char** argv) {
  google::InitGoogleLogging(argv[0]);
  try {
    return lacuna::Run(argc, argv);
  } catch (const lacuna::InputError& error) {
    std::cerr << error.what() << "\n";
    return 2;
  }
}
