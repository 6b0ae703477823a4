// Disks without space, and folders that cannot be written to.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>

#include "faults/folder_content.h"
#include "faults/trial.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr uint64_t kPage = 4096;      // bytes; a tmpfs stores whole pages
constexpr int kFirstOwnStatus = 125;  // from here on the program was not run (process.cc)
constexpr int kUnusableInput = 2;     // exit status

uint64_t PagesOf(uint64_t bytes) { return (bytes + kPage - 1) / kPage; }

// The sizes at which a disk is one page too small for each file in turn, in the order in which the
// undisturbed command has written them.
std::vector<uint64_t> TooSmallDisks(const fs::path& prepared, const fs::path& finished) {
  uint64_t used = 0;
  if (fs::exists(prepared))
    for (const auto& entry : fs::recursive_directory_iterator(prepared))
      if (entry.is_regular_file()) used += PagesOf(entry.file_size());
  std::vector<std::pair<fs::file_time_type, uint64_t>> written;
  for (const auto& entry : fs::recursive_directory_iterator(finished))
    if (entry.is_regular_file() && entry.file_size() > 0 &&
        !fs::exists(prepared / entry.path().lexically_relative(finished)))
      written.emplace_back(entry.last_write_time(), PagesOf(entry.file_size()));
  std::sort(written.begin(), written.end());
  std::vector<uint64_t> sizes;
  for (const auto& [time, pages] : written) {
    used += pages;
    sizes.push_back(std::max(used - 1, uint64_t{1}) * kPage);
  }
  return sizes;
}

// The numbers of so many of them, at even distances, with the first and the last.
std::vector<size_t> Chosen(size_t count, int most) {
  const size_t kept = std::min(count, static_cast<size_t>(std::max(most, 1)));
  std::vector<size_t> numbers;
  for (size_t k = 0; k < kept; ++k) numbers.push_back(kept == 1 ? 0 : k * (count - 1) / (kept - 1));
  return numbers;
}

}  // namespace

// Every file may have so many bytes only; then the limit is gone.
FaultResult LimitedFiles(Trial* trial) {
  FaultResult result{"no space in a file", trial->subject().name};
  for (const uint64_t largest : {0, 1000, 20'000})
    trial->Try(&result, fmt::format("files of {} bytes", largest), [&]() -> std::string {
      trial->StartOver();
      const int status = trial->Run({.largest_file = largest});
      // The log of the run is a file, too, and stays empty where nothing can be written.
      if (!(status > 0) || (largest > 0 && trial->Said().empty()))
        return fmt::format("exit status {}", status);
      return trial->Finish();
    });
  return result;
}

// The disk ends at each file in turn; then there is space.
FaultResult FullDisk(Trial* trial) {
  FaultResult result{"disk full at every write", trial->subject().name};
  fs::create_directories(trial->Results());
  if (const std::string problem = SmallDiskProblem(trial->Results()); !problem.empty()) {
    result.note = "skipped: " + problem;
    return result;
  }
  const std::vector<uint64_t> sizes = TooSmallDisks(trial->Prepared(), trial->Finished());
  int stopped = 0;
  for (const size_t k : Chosen(sizes.size(), trial->options().full_disks)) {
    const TrialOutcome& outcome =
        trial->Try(&result, fmt::format("file {}", k + 1), [&](std::mt19937_64*) {
          trial->Reset("");
          fs::create_directories(trial->Results());
          fs::remove_all(trial->Left());
          const int status = trial->Run(
              {.disk = SmallDisk{sizes[k], trial->Results(), trial->Prepared(), trial->Left()}});
          if (status < 0 || status >= kFirstOwnStatus || (status > 0 && trial->Said().empty()))
            return TrialOutcome{fmt::format("exit status {}: {}", status, trial->Said())};
          trial->Reset(trial->Left());
          // The order of the files is an estimate, so that the space may have been enough.
          if (status == 0)
            return TrialOutcome{Difference(trial->Expected(), ContentOf(trial->Results()))};
          return TrialOutcome{trial->Finish(), "stopped"};
        });
    stopped += outcome.note == "stopped";
  }
  result.note = fmt::format("{} of {} sizes stopped the command", stopped, result.trials);
  if (stopped == 0 && result.trials > 0) {
    result.survived = 0;
    result.first_failure = "no disk was too small";
  }
  return result;
}

// The command is told a folder below a file, and one that the kernel refuses to anybody.
FaultResult UnwritableOutput(Trial* trial) {
  FaultResult result{"an output that cannot be written", trial->subject().name};
  const auto content = [&] {
    std::map<std::string, std::string> files = ContentOf(trial->Folder());
    files.erase(trial->Log().filename().string());
    return files;
  };
  const fs::path changed = trial->Folder() / "experiments/unwritable.yaml";
  const fs::path below_a_file = trial->Folder() / "experiments/bend.yaml/run";
  for (const fs::path& output : {below_a_file, fs::path("/proc/run")})
    trial->Try(&result, output.parent_path().filename().string(), [&]() -> std::string {
      trial->StartOver();
      const std::map<std::string, std::string> before = content();
      std::vector<std::string> arguments = trial->subject().arguments;
      const auto option = std::find(arguments.begin(), arguments.end(), "--output");
      if (option != arguments.end()) {
        *(option + 1) = output.string();
      } else {
        std::string text = FileContent(trial->Folder() / arguments.back());
        const size_t begin = text.find("\noutput:") + 1, end = text.find('\n', begin);
        std::ofstream(changed) << text.replace(begin, end - begin, "output: " + output.string());
        arguments.back() = changed.string();
      }
      const int status = trial->Execute(arguments);
      fs::remove(changed);
      if (status != kUnusableInput || !trial->HasSaid(output.string()))
        return fmt::format("exit status {}: {}", status, trial->Said());
      return Difference(before, content());
    });
  return result;
}

}  // namespace lacuna
