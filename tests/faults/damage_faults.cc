// Files of a finished result that are damaged.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <set>

#include "faults/folder_content.h"
#include "faults/trial.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr char kRewritten[] = "no check, because every run writes the file again";
constexpr char kMadeAgain[] = "the command, which makes it again without a message";

bool IsNumbered(const std::string& name) {  // "seed_1", and "0001-de8e15fd", a sweep's case
  return name.starts_with("seed_") ||
         (name.size() > 4 && name[4] == '-' && name.find_first_not_of("0123456789") == 4);
}

// The stage of a file: the first folder below the run, or else the file itself.
std::string StageOf(const fs::path& name) {
  for (const fs::path& part : name)
    if (part != "run" && !IsNumbered(part.string())) return part.string();
  return name.string();
}

// The files that the undisturbed command writes anew each time: they cannot stay damaged.
std::set<std::string> RewrittenFiles(Trial* trial) {
  const auto past = fs::file_time_type::clock::now() - std::chrono::hours(1);
  trial->ResetToFinished();
  for (const auto& entry : fs::recursive_directory_iterator(trial->Results()))
    fs::last_write_time(entry, past);
  trial->Run();
  std::set<std::string> names;
  for (const auto& [name, hash] : trial->Expected()) {
    const fs::path file = trial->Results() / name;
    if (fs::exists(file) && fs::last_write_time(file) > past) names.insert(name);
  }
  return names;
}

// Whether a line says that something is wrong with the file.
bool IsNamed(const std::string& file, const std::string& said) {
  for (size_t at = said.find(file); at != std::string::npos; at = said.find(file, at + 1)) {
    const size_t begin = said.rfind('\n', at) + 1, end = said.find('\n', at);
    const std::string line = said.substr(begin, end - begin);
    for (const char* sign : {"damage", "changed", " instead of ", "missing", "error", "lacks"})
      if (line.find(sign) != std::string::npos) return true;
  }
  return false;
}

void Damage(const fs::path& file, bool is_cut) {
  std::string bytes = FileContent(file);
  const size_t middle = bytes.size() / 2;
  if (is_cut)
    bytes.resize(middle);
  else
    bytes[middle] = static_cast<char>(bytes[middle] ^ 4);
  std::ofstream(file, std::ios::binary) << bytes;
}

// What the messages ask for: the earlier command makes its results again, or the file is removed,
// as the mark of a case or a file of a search.
void Mend(const fs::path& file, Trial* trial) {
  if (trial->subject().preparation_mends)
    trial->Execute(trial->subject().preparation);
  else
    fs::remove(file);
}

TrialOutcome TryDamage(const std::string& name, bool is_cut, bool is_rewritten, Trial* trial) {
  const fs::path file = trial->Results() / name;
  if (fs::path(name).filename() == trial->subject().mark)
    trial->Reset(trial->Finished());
  else
    trial->ResetToFinished();
  Damage(file, is_cut);
  TrialOutcome outcome;
  outcome.failure = trial->Finish();
  const bool is_named = IsNamed(fs::path(name).filename().string(), trial->Said());
  if (!outcome.failure.empty() && is_named) {
    Mend(file, trial);
    outcome.failure = trial->Finish();
    outcome.note = "the command, which names the file and stops";
  } else if (is_named) {
    outcome.note = "the command, which names the file and makes it again";
  } else if (outcome.failure.empty()) {
    outcome.note = is_rewritten ? kRewritten : kMadeAgain;
  } else {
    outcome.note = "no check";
  }
  return outcome;
}

}  // namespace

std::vector<FaultResult> Damaged(Trial* trial) {
  std::map<std::string, std::vector<std::string>> by_stage;
  const Trial::Content prepared = ContentOf(trial->Prepared());
  for (const auto& [name, hash] : trial->Expected())
    if ((trial->subject().preparation_mends || !prepared.contains(name)) &&
        fs::file_size(trial->Finished() / name) > 0)
      by_stage[StageOf(name)].push_back(name);
  const std::set<std::string> rewritten = RewrittenFiles(trial);
  std::vector<FaultResult> results;
  for (auto& [stage, names] : by_stage) {
    FaultResult result{"damaged: " + stage, trial->subject().name};
    std::mt19937_64 random = trial->RandomOf(stage);
    std::shuffle(names.begin(), names.end(), random);
    const auto most = static_cast<size_t>(trial->options().damaged_files);
    names.resize(std::min(names.size(), most));
    std::set<std::string> noticed;
    for (const std::string& name : names)
      for (const bool is_cut : {true, false})
        noticed.insert(trial
                           ->Try(&result, name + (is_cut ? " cut" : " flipped"),
                                 [&](std::mt19937_64*) {
                                   return TryDamage(name, is_cut, rewritten.contains(name), trial);
                                 })
                           .note);
    result.note = fmt::format("noticed by {}", fmt::join(noticed, "; or "));
    results.push_back(std::move(result));
  }
  return results;
}

}  // namespace lacuna
