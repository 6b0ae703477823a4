#include "trials/case_files.h"

#include <algorithm>
#include <string>

#include "core/atomic_file.h"
#include "core/claim.h"
#include "core/error.h"
#include "core/workers.h"

namespace lacuna {

std::vector<std::filesystem::path> CasesIn(const std::filesystem::path& folder) {
  if (!std::filesystem::is_directory(folder))
    throw InputError(folder.string() + ": there is no such folder");
  std::vector<std::filesystem::path> cases;
  for (const auto& entry : std::filesystem::directory_iterator(folder))
    if (std::filesystem::exists(entry.path() / kTruthFile)) cases.push_back(entry.path());
  std::sort(cases.begin(), cases.end());
  return cases;
}

int WorkOn(const std::vector<std::filesystem::path>& cases, const std::filesystem::path& result,
           int workers, const std::function<void(size_t k)>& job) {
  const auto folder = [&](size_t k) { return (cases[k] / result).parent_path(); };
  const auto keep_failure = [&](size_t k, const std::string& reason) {
    WriteFileAtomically(folder(k) / kFailureFile, reason + "\n");
  };
  for (size_t k = 0; k < cases.size(); ++k) MakeFolder(folder(k));
  return ShareOut(cases.size(), {.workers = workers, .crashed = keep_failure}, [&](size_t k) {
    const Claim claim(folder(k) / kClaimFile);
    if (!claim.holds()) return;
    try {
      if (!std::filesystem::exists(cases[k] / result)) job(k);
      std::filesystem::remove(folder(k) / kFailureFile);
    } catch (const InputError& problem) {
      keep_failure(k, problem.what());
    }
  });
}

}  // namespace lacuna
