#include "faults/trial.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <chrono>

#include "core/error.h"
#include "core/hash.h"
#include "faults/folder_content.h"
#include "support/temporary_folder.h"

namespace lacuna {

namespace fs = std::filesystem;

Trial::Trial(const Subject& subject, const FaultOptions& options, FaultCounts* counts)
    : subject_(subject),
      options_(options),
      counts_(counts),
      folder_(fs::absolute(options.folder) / subject.name),
      results_(folder_ / subject.results) {
  for (const fs::path& folder : {folder_, Prepared(), Finished(), Left()}) fs::remove_all(folder);
  WriteExperiments(options.sources, folder_);
  if (!subject.preparation.empty()) Require(subject.preparation);
  if (fs::exists(results_)) fs::copy(results_, Prepared(), fs::copy_options::recursive);
  const auto start = std::chrono::steady_clock::now();
  Require(subject.arguments);
  duration_ = std::chrono::steady_clock::now() - start;
  expected_ = ContentOf(results_);
  // The times of the files say in which order they were written.
  fs::rename(results_, Finished());
  ResetToFinished();
}

fs::path Trial::Prepared() const { return folder_.string() + "_prepared"; }
fs::path Trial::Finished() const { return folder_.string() + "_finished"; }
fs::path Trial::Left() const { return folder_.string() + "_left"; }

std::mt19937_64 Trial::RandomOf(const std::string& name) const {
  const std::string hash =
      HashBytes(fmt::format("{} {} {}", options_.seed, subject_.name, name)).substr(0, 16);
  return std::mt19937_64(std::stoull(hash, nullptr, 16));
}

const TrialOutcome& Trial::Try(FaultResult* result, const std::string& name, const Make& make) {
  const std::string full = subject_.name + ": " + result->fault + ": " + name;
  const TrialOutcome* outcome = counts_->Find(full);
  if (outcome == nullptr) {
    std::mt19937_64 random = RandomOf(name);
    outcome = &counts_->Append(full, make(&random));
  }
  ++result->trials;
  if (outcome->failure.empty())
    ++result->survived;
  else if (result->first_failure.empty())
    result->first_failure = name + ": " + outcome->failure;
  return *outcome;
}

void Trial::Try(FaultResult* result, const std::string& name,
                const std::function<std::string()>& make) {
  Try(result, name, [&](std::mt19937_64*) { return TrialOutcome{make()}; });
}

Process Trial::Start(const ProcessOptions& options) const {
  return Process(options_.program, subject_.arguments, folder_, Log(), options);
}

int Trial::Execute(const std::vector<std::string>& arguments, const ProcessOptions& options) {
  return Process(options_.program, arguments, folder_, Log(), options).Wait();
}

void Trial::Require(const std::vector<std::string>& arguments) {
  if (Execute(arguments) != 0)
    throw InputError(fmt::format("lacuna {} fails without any fault: {}", fmt::join(arguments, " "),
                                 FileContent(Log())));
}

std::string Trial::Finish(const ProcessOptions& options) {
  if (const int status = Run(options); status != 0)
    return fmt::format("exit status {}: {}", status, FileContent(Log()));
  return Difference(expected_, ContentOf(results_));
}

std::string Trial::Said() const {
  std::string said = FileContent(Log());
  if (!fs::exists(results_)) return said;
  for (const auto& entry : fs::recursive_directory_iterator(results_))
    if (entry.path().filename() == "log.txt") said += FileContent(entry.path());
  return said;
}

void Trial::Reset(const fs::path& from) {
  fs::remove_all(results_);
  fs::create_directories(results_.parent_path());
  if (fs::exists(from)) fs::copy(from, results_, fs::copy_options::recursive);
}

void Trial::ResetToFinished() {
  Reset(Finished());
  if (subject_.mark.empty()) return;
  std::vector<fs::path> marks;
  for (const auto& entry : fs::recursive_directory_iterator(results_))
    if (entry.path().filename() == subject_.mark) marks.push_back(entry.path());
  for (const fs::path& mark : marks) fs::remove(mark);
}

}  // namespace lacuna
