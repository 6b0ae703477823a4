// manifest.json: the configuration and the inputs of a run, and its valid results.
//
// It contains neither the time nor anything about the computer: the same run, by the same program
// and libraries, gives the same bytes on every processor with the same vector instructions. On
// others registration (registration/gaussian_sums.h) and OpenBLAS round differently, so that the
// results and their hashes differ.
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
  std::string name;  // path relative to the stage's folder, with '/'
  uint64_t size = 0;
  std::string hash;
};

// The result of one stage, such as `surface` or `fit`.
struct StageResult {
  std::string key;  // StageKey of the configuration and the inputs that led to it
  std::vector<StoredFile> files;
};

// NOLINTNEXTLINE(bugprone-exception-escape): the JSON value checks itself when moved
struct Manifest {
  int schema_version = kManifestSchemaVersion;
  std::string program_version;
  std::map<std::string, std::string> library_versions;
  nlohmann::json configuration;               // all values in SI, defaults included
  std::map<std::string, std::string> inputs;  // InputName() → hash of the content
  uint64_t seed = 0;
  std::map<std::string, StageResult> stages;  // by name of the stage
  bool finished = false;  // whether every stage exists and belongs to this configuration
};

// Everything that determines the result of a stage. `code_version` must be increased when a change
// of the stage's code changes its result.
struct StageIdentity {
  std::string stage;
  int code_version = 0;
  nlohmann::json options;
  std::map<std::string, std::string> inputs;  // name → hash of a file or of an earlier stage
};
// The hash of the identity, under which the result is stored.
std::string StageKey(const StageIdentity& identity);

// The name under which Manifest::inputs lists a file that was read: its path relative to `folder`
// if it lies in there, and otherwise its own name, so that it depends neither on where the data lie
// nor on how the paths were spelled.
std::string InputName(const std::filesystem::path& file, const std::filesystem::path& folder);

// Writes the file atomically. Throws InputError if that fails.
void WriteManifest(const Manifest& manifest, const std::filesystem::path& file);

// Throws InputError if the file is absent, damaged, or written by a later version of Lacuna.
Manifest ReadManifest(const std::filesystem::path& file);

}  // namespace lacuna

#endif  // LACUNA_RECORD_MANIFEST_H_
