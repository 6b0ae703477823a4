// lacuna compare RUN
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "app/commands.h"
#include "comparison/comparison.h"
#include "core/progress.h"

namespace lacuna {
namespace {

void PrintTable(const Comparison& comparison) {
  fmt::print("\n  {:14} {:9} {:>7} {:>10} {:>8} {:>8} {:>12} {:>12}\n", "recording", "", "frames",
             "rms, mm", "/ noise", "/ floor", "correlation", "worst marker");
  for (const ComparedRecording& recording : comparison.recordings) {
    for (const ComparedPart& part : recording.parts) {
      fmt::print("  {:14} {:9} {:>7} {:>10.3f} {:>8.1f} {:>8.1f} {:>12.2f} {:>12}\n",
                 recording.name, part.fitted ? "fitted" : "held out", part.last - part.first + 1,
                 1e3 * part.rms, part.in_noise, part.in_floor, part.in_time.lag_one,
                 part.worst_marker < 0 ? "-" : recording.markers[part.worst_marker]);
    }
  }
}

// Broken between words at 96 columns.
void PrintParagraph(const std::string& text) {
  constexpr size_t kWidth = 96;
  std::string line;
  size_t columns = 0;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find(' ', begin), text.size());
    const std::string word = text.substr(begin, end - begin);
    // Continuation bytes of UTF-8 take no column.
    const auto width = static_cast<size_t>(std::count_if(word.begin(), word.end(), [](char c) {
      return (static_cast<unsigned char>(c) >> 6) != 2;
    }));
    if (columns > 0 && columns + 1 + width > kWidth) {
      fmt::print("{}\n", line);
      line.clear();
      columns = 0;
    }
    line += (columns > 0 ? " " : "") + word;
    columns += (columns > 0 ? 1 : 0) + width;
    begin = end + 1;
  }
  fmt::print("{}\n", line);
}

int Compare(const std::string& run, bool replay) {
  Comparison comparison = CompareRun(run);
  // Fields of an earlier comparison are not this one's.
  for (size_t r = 0; r < comparison.recordings.size(); ++r)
    std::filesystem::remove_all(std::filesystem::path(run) / "comparison" / std::to_string(r));
  Progress progress;
  if (replay) CompareMotion(run, &progress, &comparison);
  SaveComparison(comparison, run);
  PrintTable(comparison);
  for (const std::string& paragraph : ComparisonInWords(comparison)) {
    fmt::print("\n");
    PrintParagraph(paragraph);
  }
  for (const std::string& note : comparison.notes) {
    fmt::print("\n");
    PrintParagraph(note);
  }
  fmt::print(
      "\nWritten to {}/comparison\n"
      "  comparison.json   all of it, with the words\n"
      "  by_frame.csv, by_marker.csv   the error of each\n"
      "  against.csv       the error against time, displacement, speed, strain, height, distance\n",
      run);
  for (size_t r = 0; r < comparison.recordings.size(); ++r) {
    const ComparedRecording& recording = comparison.recordings[r];
    if (recording.field_frames == 0) continue;
    fmt::print("  {}/body.pvd, {}/markers.pvd   fields of {}, {} of {} frames\n", r, r,
               recording.name, recording.field_frames, recording.frames.size());
  }
  if (std::any_of(comparison.recordings.begin(), comparison.recordings.end(),
                  [](const auto& recording) { return recording.force && recording.force->usable; }))
    fmt::print("  unexplained_force.csv   net force, torque, power and place over time\n");
  return 0;
}

}  // namespace

void AddCompare(CLI::App* app, std::function<int()>* command) {
  CLI::App* compare =
      app->add_subcommand("compare", "Tell where and when a fitted model fails, and by how much");
  compare->footer(
      "The run is one of `lacuna fit`. What is fitted and what is held out are told apart;\n"
      "docs/prediction.md says what the words mean.");
  auto run = std::make_shared<std::string>();
  compare->add_option("run", *run, "The run's folder, results/NAME")->required();
  auto files_only = std::make_shared<bool>(false);
  compare->add_flag("--files-only", *files_only,
                    "Do not run the model again: no strain, height, fields, unexplained force");
  compare->callback([command, run, files_only] {
    *command = [run, files_only] { return Compare(*run, !*files_only); };
  });
}

}  // namespace lacuna
