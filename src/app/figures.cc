// lacuna figures [FOLDER]
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/commands.h"
#include "core/atomic_file.h"
#include "core/error.h"
#include "paper/drop_figure.h"
#include "paper/table1_figures.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::string folder = "experiments/figures";
  std::string output = "results/figures";
  std::string table1 = "results/table1";
  std::vector<int> only;
};

bool IsWanted(const Arguments& arguments, int figure) {
  return arguments.only.empty() ||
         std::find(arguments.only.begin(), arguments.only.end(), figure) != arguments.only.end();
}

// Prints the text of the figure and, if it was not drawn, the reason. Returns whether it was drawn.
bool Told(int figure, const std::string& text, const PictureResult& picture) {
  fmt::print("{}\n", text);
  if (!picture.IsUsable()) fmt::print(stderr, "lacuna: figure {}: {}\n", figure, picture.message);
  return picture.IsUsable();
}

bool MakeDrop(const Arguments& arguments, Progress* progress) {
  const DropStudy study = ReadDrop(Config::Load(fs::path(arguments.folder) / "figure1.yaml"));
  const std::vector<DropRun> runs = RunDrop(study, fs::path(arguments.output) / "drop", progress);
  return Told(1, DropText(runs), WriteDropFigure(study, runs, arguments.output));
}

// Figures 3 to 6, which come from Table 1's recording.
bool MakeOthers(const Arguments& arguments, Progress* progress) {
  const Table1FigureSettings settings =
      ReadTable1Figures(Config::Load(fs::path(arguments.folder) / "figures3to6.yaml"));
  const Table1Study table1 = ReadTable1(settings.table1);
  const Table1Scans scans =
      PrepareScans(table1, settings, arguments.table1, arguments.output, progress);
  bool all = true;
  const auto make = [&](int figure, const std::string& name, const auto& draw) {
    if (!IsWanted(arguments, figure)) return;
    try {
      const FigureContent content = draw();
      all = Told(figure, content.text, WriteFigure(content, name, arguments.output)) && all;
    } catch (const InputError& problem) {
      fmt::print(stderr, "lacuna: figure {} was not drawn: {}\n", figure, problem.what());
      all = false;
    }
  };
  make(3, "figure3", [&] { return DrawCloudAndSurface(scans, settings); });
  make(4, "figure4", [&] { return DrawMeshes(table1, scans, settings); });
  make(4, "figure4_own_surface", [&] { return DrawOwnSurfaceMeshes(table1, scans, settings); });
  make(5, "figure5", [&] { return DrawBend(table1, scans, settings); });
  make(6, "figure6", [&] { return DrawAlignment(table1, scans, settings, arguments.table1); });
  return all;
}

int RunFigures(const Arguments& arguments) {
  MakeFolder(arguments.output);
  Progress progress;
  bool all = true;
  if (IsWanted(arguments, 1)) all = MakeDrop(arguments, &progress);
  const auto wants = [&](int figure) { return IsWanted(arguments, figure); };
  if (wants(3) || wants(4) || wants(5) || wants(6)) all = MakeOthers(arguments, &progress) && all;
  fmt::print("The figures were written to {}\n", arguments.output);
  return all ? 0 : 1;
}

}  // namespace

void AddFigures(CLI::App* app, std::function<int()>* command) {
  CLI::App* figures = app->add_subcommand(
      "figures", "Draw the paper's Figures 1 and 3 to 6, and write the numbers behind them");
  figures->footer(
      "FOLDER holds figure1.yaml and figures3to6.yaml, which say what is drawn (docs/figures.md).\n"
      "Figure 6 shows the optima of Table 1: run `lacuna table1` before it.");
  auto arguments = std::make_shared<Arguments>();
  figures->add_option("folder", arguments->folder,
                      "Folder of the figures' settings (experiments/figures)");
  figures->add_option("-o,--output", arguments->output, "Folder of the figures (results/figures)");
  figures->add_option("--table1", arguments->table1,
                      "Folder where `lacuna table1` left its results (results/table1)");
  figures->add_option("--only", arguments->only, "These figures only, e.g. --only 1,3")
      ->delimiter(',')
      ->allow_extra_args(false)
      ->check(CLI::IsMember({1, 3, 4, 5, 6}));
  figures->callback(
      [command, arguments] { *command = [arguments] { return RunFigures(*arguments); }; });
}

}  // namespace lacuna
