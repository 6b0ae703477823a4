#include "faults/faults.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/hash.h"
#include "faults/trial.h"

namespace lacuna {
namespace {

// A cell of the table: one line without bars, and not too long.
std::string Cell(std::string text) {
  constexpr size_t kMost = 300;
  std::replace(text.begin(), text.end(), '\n', ' ');
  std::replace(text.begin(), text.end(), '|', '/');
  if (text.size() > kMost) text = text.substr(0, kMost) + " …";
  return text.empty() ? "–" : text;
}

}  // namespace

std::vector<FaultResult> TryFaults(const Subject& subject, const FaultOptions& options,
                                   const std::function<void(const FaultResult&)>& report) {
  const std::filesystem::path file = options.folder / "counts.jsonl";
  if (std::filesystem::exists(options.folder) && !std::filesystem::is_empty(options.folder) &&
      !std::filesystem::exists(file))
    throw InputError({options.folder.string()},
                     "is not empty and holds no counts.jsonl; choose another folder");
  std::filesystem::create_directories(options.folder);
  FaultCounts counts(file, fmt::format("{} by {} seed {}", HashFile(options.program),
                                       HashFile("/proc/self/exe"), options.seed));
  Trial trial(subject, options, &counts);
  std::vector<FaultResult> all;
  const auto keep = [&](FaultResult result) {
    report(result);
    all.push_back(std::move(result));
  };
  for (FaultResult& one : Killed(&trial)) keep(std::move(one));
  keep(LimitedFiles(&trial));
  keep(FullDisk(&trial));
  keep(TwoProcesses(&trial));
  keep(FileTimes(&trial));
  keep(FakedClock(&trial));
  for (FaultResult& one : Damaged(&trial)) keep(std::move(one));
  keep(ChangedInput(&trial));
  // Where something had to run before, the command writes into the folder of that.
  if (subject.preparation.empty()) keep(UnwritableOutput(&trial));
  if (subject.reads_input_late) keep(InputChangedMeanwhile(&trial));
  return all;
}

std::string FaultTable(const std::vector<FaultResult>& results) {
  std::string text =
      "| fault | command | trials | survived | remark | first failure "
      "|\n|---|---|---|---|---|---|\n";
  for (const FaultResult& one : results)
    text += fmt::format("| {} | `{}` | {} | {} | {} | {} |\n", one.fault, one.subject, one.trials,
                        one.survived, Cell(one.note), Cell(one.first_failure));
  return text;
}

}  // namespace lacuna
