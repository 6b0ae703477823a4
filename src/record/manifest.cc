#include "record/manifest.h"

#include <fmt/format.h>

#include "core/atomic_file.h"
#include "core/error.h"
#include "core/hash.h"
#include "core/json_file.h"

namespace lacuna {

using nlohmann::json;

std::string StageKey(const StageIdentity& identity) {
  // CBOR distinguishes NaN, infinity and null, which are all null in JSON text.
  const std::vector<uint8_t> bytes = json::to_cbor({{"stage", identity.stage},
                                                    {"code_version", identity.code_version},
                                                    {"options", identity.options},
                                                    {"inputs", identity.inputs}});
  return HashBytes({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

std::string InputName(const std::filesystem::path& file, const std::filesystem::path& folder) {
  namespace fs = std::filesystem;
  const fs::path inside = fs::absolute(file).lexically_normal().lexically_proximate(
      fs::absolute(folder).lexically_normal());
  const bool is_inside = inside.is_relative() && !inside.empty() && *inside.begin() != "..";
  return (is_inside ? inside : file.filename()).generic_string();
}

void WriteManifest(const Manifest& manifest, const std::filesystem::path& file) {
  json stages = json::object();
  for (const auto& [name, result] : manifest.stages) {
    json files = json::array();
    for (const StoredFile& stored : result.files) {
      files.push_back({{"name", stored.name}, {"size", stored.size}, {"hash", stored.hash}});
    }
    stages[name] = {{"key", result.key}, {"files", files}};
  }
  const json document{{"schema_version", manifest.schema_version},
                      {"program_version", manifest.program_version},
                      {"library_versions", manifest.library_versions},
                      {"configuration", manifest.configuration},
                      {"inputs", manifest.inputs},
                      {"seed", manifest.seed},
                      {"stages", stages},
                      {"finished", manifest.finished}};
  WriteFileAtomically(file, document.dump(2, ' ', false, json::error_handler_t::replace) + "\n");
}

Manifest ReadManifest(const std::filesystem::path& file) {
  const auto read = [&](const json& document) {
    Manifest manifest;
    manifest.schema_version = document.at("schema_version");
    if (manifest.schema_version > kManifestSchemaVersion) {
      throw InputError({file.string()},
                       fmt::format("has schema_version {}, from a later version of Lacuna; this "
                                   "one reads up to {}",
                                   manifest.schema_version, kManifestSchemaVersion));
    }
    manifest.program_version = document.at("program_version");
    document.at("library_versions").get_to(manifest.library_versions);
    manifest.configuration = document.at("configuration");
    document.at("inputs").get_to(manifest.inputs);
    manifest.seed = document.at("seed");
    for (const auto& [name, stage] : document.at("stages").items()) {
      StageResult result;
      result.key = stage.at("key");
      for (const json& stored : stage.at("files")) {
        result.files.push_back({stored.at("name"), stored.at("size"), stored.at("hash")});
      }
      manifest.stages[name] = std::move(result);
    }
    manifest.finished = document.at("finished");
    return manifest;
  };
  return ReadJsonFile(file, read, "a valid manifest");
}

}  // namespace lacuna
