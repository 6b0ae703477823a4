// Rewriting a YAML file with changed values into a self-contained file for another folder.
#ifndef LACUNA_CORE_CHANGED_YAML_H_
#define LACUNA_CORE_CHANGED_YAML_H_

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace lacuna {

// One entry to set or remove.
struct YamlChange {
  std::string field;           // "mesh.max_volume", "effects[0].eta"
  std::string value;           // YAML: "150 mm^3", "[0, 0, 1 N]"; "~" removes the entry
  std::filesystem::path file;  // the file that asks for the change: relative paths start there
};

// Returns the YAML of `file` with the changes applied and with every piece that it includes by
// `use:` (core/config.h) inserted. The text is meant to be written into `folder`: relative paths in
// entries whose key is one of `path_keys`, at any depth, are rewritten to start there. A change to
// an absent entry adds it and the mappings above it. Comments are lost. Throws InputError for a bad
// file like Config::Load, and for a bad change with the message "field: …".
std::string ChangedYaml(const std::filesystem::path& file, const std::vector<YamlChange>& changes,
                        const std::set<std::string>& path_keys,
                        const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_CORE_CHANGED_YAML_H_
