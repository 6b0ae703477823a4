// manifest.json: what a run was asked to do, from which inputs, and which of its results stand.
//
// Nothing in it depends on the machine or the hour: the same run gives the same bytes anywhere.
#ifndef LACUNA_RECORD_MANIFEST_H_
#define LACUNA_RECORD_MANIFEST_H_

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace lacuna {

inline constexpr int kManifestSchemaVersion = 1;

struct StoredFile {
  std::string name;  // relative to the stage's folder, with '/'
  uint64_t size = 0;
  std::string hash;
};

struct StageResult {
  std::string key;  // see StageKey
  std::vector<StoredFile> files;
};

// NOLINTNEXTLINE(bugprone-exception-escape): the JSON value checks itself when moved
struct Manifest {
  int schema_version = kManifestSchemaVersion;
  std::string program_version;
  std::map<std::string, std::string> library_versions;
  nlohmann::json configuration;               // resolved: all values, defaults included, in SI
  std::map<std::string, std::string> inputs;  // file as the user names it → hash of its content
  uint64_t seed = 0;
  std::map<std::string, StageResult> stages;
  bool finished = false;  // every stage belongs to this configuration and none is missing
};

// All that decides a stage's result. Whoever changes the stage's code so that its result changes
// raises `code_version`.
struct StageIdentity {
  std::string stage;
  int code_version = 0;
  nlohmann::json options;
  std::map<std::string, std::string> inputs;  // name → hash: of files, or of earlier stages
};
std::string StageKey(const StageIdentity& identity);

void SaveManifest(const Manifest& manifest, const std::filesystem::path& file);

// Throws InputError when the file is absent, damaged, or written by a later version of Lacuna.
Manifest LoadManifest(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_MANIFEST_H_
