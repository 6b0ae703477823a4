// The folder of a run: results by stage, which are valid only if manifest.json lists their hashes.
//
//   <run>/manifest.json        written atomically after each stage
//   <run>/<stage>/...          the files of one stage
//   <run>/.<stage>.partial/    a stage being written; never read
//
// A stage is stored under a key made from everything that determines its result (StageKey). When
// the same command runs again, with the same versions of the program and its libraries, it finds
// the key and skips the stage. A crash, a full disk or an interrupt leaves at worst a folder that
// the manifest does not list. The folder of a stage belongs to the program: all other files in it
// are deleted when the stage is computed again.
//
// Any number of commands may begin in the same folder at the same moment, also in a new one. One of
// them gets it; the others are told that it is in use, until the first has ended. A command that
// gets the folder after another one finds the stages that the other has stored.
#ifndef LACUNA_RECORD_RUN_DIRECTORY_H_
#define LACUNA_RECORD_RUN_DIRECTORY_H_

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>

#include "core/claim.h"
#include "record/input_files.h"
#include "record/manifest.h"

namespace lacuna {

// Whether a stored result can be used, and why not.
struct StageCheck {
  enum class Status { kNotRun, kAbsent, kOtherKey, kDamaged, kReady };
  Status status = Status::kNotRun;
  std::string message;  // for kDamaged the file and its fault
  bool IsUsable() const { return status == Status::kReady; }
};

class RunDirectory {
 public:
  // Opens or creates the folder and locks it during the lifetime of the object, also against other
  // threads of this process. The lock is released when the process ends, even by a crash. Throws
  // InputError if the folder is not writable, "is in use by another run" (with its host and process
  // id, unless it has just ended), or contains something other than a run. What other runs create
  // in the folder at the same moment is never taken for the latter.
  explicit RunDirectory(const std::filesystem::path& folder);

  const std::filesystem::path& Folder() const { return folder_; }
  std::filesystem::path StageFolder(const std::string& stage) const { return folder_ / stage; }
  const Manifest& manifest() const { return manifest_; }

  // Declares the configuration and the inputs of the run, which is unfinished from here until
  // Finish.
  void Begin(const nlohmann::json& configuration, const std::map<std::string, std::string>& inputs,
             uint64_t seed);

  // From here on, Store and Finish throw InputError where one of these files has changed.
  void Watch(const InputFiles& inputs) { watched_ = inputs; }

  // Checks whether the stage has a valid result for this key. Reads each file and compares its
  // hash.
  StageCheck Check(const std::string& stage, const std::string& key);
  bool Has(const std::string& stage, const std::string& key) {
    return Check(stage, key).IsUsable();
  }

  // Calls write(folder) with an empty folder, whose contents then become the result of the stage.
  // If `write` throws, or a watched file has changed, the folder is removed, an earlier result is
  // kept and the exception is rethrown.
  void Store(const std::string& stage, const std::string& key,
             const std::function<void(const std::filesystem::path& folder)>& write);

  // One hash for all files of a stored stage, an input of the stages that read it.
  std::string ResultHash(const std::string& stage) const;

  // Declares the run finished. Removes stages of earlier configurations, which were neither stored
  // nor found ready since Begin.
  void Finish();

 private:
  void Save() const;

  std::filesystem::path folder_;
  std::optional<Claim> lock_;
  Manifest manifest_;
  InputFiles watched_;
  std::set<std::string> current_;  // stages stored or found ready since Begin
};

// The folder of a stage of a finished run, for commands that only read. Throws InputError if the
// run is not finished, or if the stage is absent or damaged.
std::filesystem::path FinishedStage(const std::filesystem::path& run, const std::string& stage);

}  // namespace lacuna

#endif  // LACUNA_RECORD_RUN_DIRECTORY_H_
