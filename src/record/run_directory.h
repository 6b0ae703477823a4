// A run's folder: results by stage, trusted only when manifest.json vouches for every byte.
//
//   <run>/manifest.json        written last, atomically, after each stage
//   <run>/<stage>/...          the files of one stage
//   <run>/.<stage>.partial/    a stage being written; never read
//
// A stage is stored under a key made from all that decides its result (StageKey). The same command
// run again, by the same version with the same libraries, finds the key and skips the stage; a
// crash, a full disk or an interrupt leaves at worst a folder that no manifest names. A stage's
// folder belongs to the program: whatever else lies in it goes when the stage is computed anew.
#ifndef LACUNA_RECORD_RUN_DIRECTORY_H_
#define LACUNA_RECORD_RUN_DIRECTORY_H_

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "core/claim.h"
#include "record/manifest.h"

namespace lacuna {

struct StageCheck {
  enum class Status { kNotRun, kAbsent, kOtherKey, kDamaged, kReady };
  Status status = Status::kNotRun;
  std::string message;  // for kDamaged: which file, and what is wrong with it
  bool IsUsable() const { return status == Status::kReady; }
};

class RunDirectory {
 public:
  // Opens the folder or creates it, and locks it for this process; the lock goes with the process,
  // however that ends. Throws InputError when the folder cannot be written, is used by another run,
  // or holds something else than a run.
  explicit RunDirectory(const std::filesystem::path& folder);

  const std::filesystem::path& Folder() const { return folder_; }
  std::filesystem::path StageFolder(const std::string& stage) const { return folder_ / stage; }
  const Manifest& manifest() const { return manifest_; }

  // Says what the run is about to do. From here on until Finish it counts as unfinished.
  void Begin(const nlohmann::json& configuration, const std::map<std::string, std::string>& inputs,
             uint64_t seed);

  // Whether the stage's result stands under this key, each file re-read and compared with its hash.
  StageCheck Check(const std::string& stage, const std::string& key);
  bool Has(const std::string& stage, const std::string& key) {
    return Check(stage, key).IsUsable();
  }

  // Calls write(folder) with an empty folder and makes what it leaves there the stage's result. If
  // it throws, that folder is removed, an earlier result stands and the exception goes on.
  void Store(const std::string& stage, const std::string& key,
             const std::function<void(const std::filesystem::path& folder)>& write);

  // One hash for all files of a stored stage: the input of the stages that read it.
  std::string ResultHash(const std::string& stage) const;

  // Declares the run finished. Stages that were neither stored nor found ready since Begin belong
  // to an earlier configuration and are removed.
  void Finish();

 private:
  void Save() const;

  std::filesystem::path folder_;
  std::optional<Claim> lock_;
  Manifest manifest_;
  std::set<std::string> current_;  // stages stored or found ready since Begin
};

// The folder of a stage of a finished run, for the commands that only read. Throws InputError when
// the run is not finished, or the stage is absent or damaged.
std::filesystem::path FinishedStage(const std::filesystem::path& run, const std::string& stage);

}  // namespace lacuna

#endif  // LACUNA_RECORD_RUN_DIRECTORY_H_
