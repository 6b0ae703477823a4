#include "trials/case_files.h"

#include <algorithm>
#include <string>
#include <utility>

#include "core/atomic_file.h"
#include "core/claim.h"
#include "core/error.h"
#include "core/hash.h"

namespace lacuna {
namespace {

std::vector<std::filesystem::path> FoldersWith(const char* file,
                                               const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder))
    throw InputError(folder.string() + ": there is no such folder");
  std::vector<std::filesystem::path> cases;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (std::filesystem::exists(entry.path() / file)) cases.push_back(entry.path());
  std::sort(cases.begin(), cases.end());
  return cases;
}

}  // namespace

std::vector<std::filesystem::path> CasesIn(const std::filesystem::path& folder) {
  return FoldersWith(kTruthFile, folder);
}

std::vector<std::filesystem::path> SkippedCasesIn(const std::filesystem::path& folder) {
  return FoldersWith(kSkippedFile, folder);
}

std::vector<size_t> WorkOrder(const std::vector<std::filesystem::path>& cases) {
  std::vector<std::pair<std::string, size_t>> order;
  for (size_t k = 0; k < cases.size(); ++k)
    order.emplace_back(HashBytes(cases[k].filename().string()), k);
  std::sort(order.begin(), order.end());
  std::vector<size_t> indices;
  for (const auto& [hash, k] : order) indices.push_back(k);
  return indices;
}

bool ShareCases(const std::vector<std::filesystem::path>& cases,
                const std::filesystem::path& of_lock, const WorkerOptions& options,
                const std::function<void(size_t k)>& job) {
  const std::vector<size_t> order = WorkOrder(cases);
  WorkerOptions ordered = options;
  if (options.crashed)
    ordered.crashed = [&](size_t at, const std::string& reason) {
      options.crashed(order[at], reason);
    };
  for (const std::filesystem::path& own : cases) MakeFolder(own / of_lock);
  return RunInProcesses(cases.size(), ordered, [&](size_t at) {
    const Claim claim(cases[order[at]] / of_lock / kClaimFile);
    if (claim.holds()) job(order[at]);
  });
}

bool WorkOn(const std::vector<std::filesystem::path>& cases, const std::filesystem::path& result,
            int workers, const std::function<void(size_t k)>& job) {
  const auto failure = [&](size_t k) { return cases[k] / result.parent_path() / kFailureFile; };
  const auto keep_failure = [&](size_t k, const std::string& reason) {
    WriteFileAtomically(failure(k), reason + "\n");
  };
  return ShareCases(cases, result.parent_path(), {.workers = workers, .crashed = keep_failure},
                    [&](size_t k) {
                      try {
                        if (!std::filesystem::exists(cases[k] / result)) job(k);
                        std::filesystem::remove(failure(k));
                      } catch (const InputError& problem) {
                        keep_failure(k, problem.what());
                      }
                    });
}

}  // namespace lacuna
