#include "record/run_directory.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <glog/logging.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "record/library_versions.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr char kManifestName[] = "manifest.json";
constexpr char kLockName[] = ".lock";

fs::path PartialFolder(const fs::path& run, const std::string& stage) {
  return run / ("." + stage + ".partial");
}

bool IsPartialFolder(const fs::path& path) {
  return path.filename().string().starts_with(".") && path.extension() == ".partial";
}

void CheckStageName(const std::string& stage) {
  CHECK(!stage.empty() &&
        stage.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == std::string::npos)
      << "'" << stage << "' is not a valid name of a stage";
}

bool HasForeignFiles(const fs::path& folder) {
  for (const auto& entry : fs::directory_iterator(folder)) {
    const fs::path& path = entry.path();
    if (path.filename() != kLockName && !IsPartialFolder(path) && !IsTemporaryFile(path))
      return true;
  }
  return false;
}

// Refuses a folder that contains something other than a run. Another process may be making its
// first stage at this moment. Its manifest is written before the folder of the stage. If the
// manifest is looked for after the folder was listed, a stage that was listed therefore always has
// one.
void RefuseForeignFolder(const fs::path& folder) {
  if (HasForeignFiles(folder) && !fs::exists(folder / kManifestName))
    throw InputError(
        {folder.string()},
        fmt::format("is not a run folder (it has no {}) and is not empty; choose another",
                    kManifestName));
}

// Whether a manifest is damaged so that it is no JSON any more. The run then starts over. Manifests
// of later versions, and files of other programs, are refused by ReadManifest instead.
bool IsNoJson(const fs::path& file) {
  std::ifstream stream(file);
  const bool is_none =
      nlohmann::json::parse(stream, nullptr, /*allow_exceptions=*/false).is_discarded();
  if (is_none)
    LOG(WARNING) << file.string() << ": is damaged; everything in this folder is computed again";
  return is_none;
}

void SyncFile(const fs::path& file) {
  const int descriptor = open(file.c_str(), O_RDONLY | O_CLOEXEC);
  const bool synced = descriptor >= 0 && fsync(descriptor) == 0;
  const int error = errno;
  if (descriptor >= 0) close(descriptor);
  if (!synced) {
    throw InputError({file.string()}, fmt::format("cannot be written: {}", std::strerror(error)));
  }
}

// Flushes all files of a folder to the disk and returns them, sorted by name.
std::vector<StoredFile> SyncAndList(const fs::path& folder) {
  std::vector<StoredFile> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (entry.is_directory()) {
      SyncFolder(entry.path());
      continue;
    }
    SyncFile(entry.path());
    files.push_back({entry.path().lexically_relative(folder).generic_string(), entry.file_size(),
                     HashFile(entry.path())});
  }
  SyncFolder(folder);
  std::sort(files.begin(), files.end(),
            [](const StoredFile& a, const StoredFile& b) { return a.name < b.name; });
  return files;
}

// A description of the first file that is missing or changed; empty if there is none.
std::string FindDamage(const fs::path& folder, const StageResult& result) {
  for (const StoredFile& stored : result.files) {
    const fs::path file = folder / stored.name;
    std::error_code error;
    const auto size = fs::file_size(file, error);
    if (error) return file.string() + " is missing";
    if (size != stored.size) {
      return fmt::format("{} has {} bytes instead of {}", file.string(), size, stored.size);
    }
    if (HashFile(file) != stored.hash) return file.string() + " has been changed";
  }
  return "";
}

}  // namespace

RunDirectory::RunDirectory(const fs::path& folder) : folder_(folder) {
  std::error_code error;
  fs::create_directories(folder_, error);
  if (error || !fs::is_directory(folder_)) {
    const std::string cause = error ? error.message() : "it is not a folder";
    throw InputError({folder_.string()}, "cannot be used as a run folder: " + cause);
  }
  RefuseForeignFolder(folder_);
  const fs::path file = folder_ / kLockName;
  const bool was_run = fs::exists(file);
  // A manifest of another program, in whose folder no run has been, is refused before a lock is
  // left there: the next attempt would take it for a damaged manifest of a run.
  if (!was_run && fs::exists(folder_ / kManifestName)) ReadManifest(folder_ / kManifestName);
  lock_.emplace(file);
  if (!lock_->holds()) {
    const std::string holder = HolderOf(file);  // empty if the other run has just ended
    throw InputError({folder_.string()}, "is in use by another run" +
                                             (holder.empty() ? "" : fmt::format(" ({})", holder)));
  }
  for (const auto& entry : fs::directory_iterator(folder_)) {
    if (IsPartialFolder(entry.path())) fs::remove_all(entry.path());
  }
  RemoveLeftTemporaries(folder_);
  if (fs::exists(folder_ / kManifestName) && !(was_run && IsNoJson(folder_ / kManifestName)))
    manifest_ = ReadManifest(folder_ / kManifestName);
  // Another version of the program or of a library may give other results.
  if (manifest_.program_version != ProgramVersion() ||
      manifest_.library_versions != LibraryVersions()) {
    manifest_.stages.clear();
  }
  manifest_.schema_version = kManifestSchemaVersion;
  manifest_.program_version = ProgramVersion();
  manifest_.library_versions = LibraryVersions();
}

void RunDirectory::Begin(const nlohmann::json& configuration,
                         const std::map<std::string, std::string>& inputs, uint64_t seed) {
  manifest_.configuration = configuration;
  manifest_.inputs = inputs;
  manifest_.seed = seed;
  manifest_.finished = false;
  current_.clear();
  Save();
}

StageCheck RunDirectory::Check(const std::string& stage, const std::string& key) {
  CheckStageName(stage);
  using Status = StageCheck::Status;
  const auto found = manifest_.stages.find(stage);
  if (found == manifest_.stages.end()) return {Status::kAbsent, ""};
  if (found->second.key != key) {
    return {Status::kOtherKey, "the options or inputs of " + stage + " have changed"};
  }
  const std::string damage = FindDamage(StageFolder(stage), found->second);
  if (!damage.empty()) {
    LOG(WARNING) << damage << "; " << stage << " is computed again";
    return {Status::kDamaged, damage};
  }
  current_.insert(stage);
  return {Status::kReady, ""};
}

void RunDirectory::Store(const std::string& stage, const std::string& key,
                         const std::function<void(const fs::path& folder)>& write) {
  CheckStageName(stage);
  const fs::path partial = PartialFolder(folder_, stage);
  StageResult result;
  result.key = key;
  try {
    fs::remove_all(partial);
    fs::create_directory(partial);
    write(partial);
    watched_.RequireUnchanged();
    result.files = SyncAndList(partial);
    // From here to the last Save the manifest does not list the stage, whatever happens in between.
    if (manifest_.stages.erase(stage) > 0) Save();
    fs::remove_all(StageFolder(stage));
    fs::rename(partial, StageFolder(stage));
    SyncFolder(folder_);
  } catch (const fs::filesystem_error& error) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw InputError({partial.string()}, "cannot be written: " + error.code().message());
  } catch (...) {
    std::error_code ignored;
    fs::remove_all(partial, ignored);
    throw;
  }
  manifest_.stages[stage] = std::move(result);
  current_.insert(stage);
  Save();
}

std::string RunDirectory::ResultHash(const std::string& stage) const {
  const auto found = manifest_.stages.find(stage);
  CHECK(found != manifest_.stages.end()) << "stage " << stage << " has no result yet";
  std::string listing;
  for (const StoredFile& file : found->second.files) listing += file.name + '\0' + file.hash;
  return HashBytes(listing);
}

void RunDirectory::Finish() {
  watched_.RequireUnchanged();
  std::vector<std::string> outdated;
  for (const auto& [stage, result] : manifest_.stages) {
    if (!current_.contains(stage)) outdated.push_back(stage);
  }
  for (const std::string& stage : outdated) manifest_.stages.erase(stage);
  manifest_.finished = true;
  Save();
  std::error_code ignored;  // a folder that the manifest does not list does no harm
  for (const std::string& stage : outdated) fs::remove_all(StageFolder(stage), ignored);
}

void RunDirectory::Save() const { WriteManifest(manifest_, folder_ / kManifestName); }

fs::path FinishedStage(const fs::path& run, const std::string& stage) {
  const Manifest manifest = ReadManifest(run / kManifestName);
  if (!manifest.finished) {
    throw InputError({run.string()},
                     "is the folder of a run that was not finished; start the run again and it "
                     "resumes where it stopped");
  }
  const auto found = manifest.stages.find(stage);
  if (found == manifest.stages.end()) {
    throw InputError({run.string()}, "has no results of the stage '" + stage + "'");
  }
  const std::string damage = FindDamage(run / stage, found->second);
  if (!damage.empty()) throw InputError({run.string()}, "is damaged: " + damage);
  return run / stage;
}

}  // namespace lacuna
