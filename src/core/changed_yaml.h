// Rewriting a YAML file with changed values as a self-contained file for another folder.
#ifndef LACUNA_CORE_CHANGED_YAML_H_
#define LACUNA_CORE_CHANGED_YAML_H_

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace lacuna {

// One entry to set or remove.
struct YamlChange {
  std::string field;  // e.g. "mesh.max_volume" or "effects[0].eta"; "effects[+]" adds an item
  std::string value;  // YAML, e.g. "150 mm^3" or "[0, 0, 1 N]"; "~" removes the entry
  std::filesystem::path file;  // the file with the change; its folder is the base of relative paths
};

// Returns the YAML of `file` with the changes applied and with every piece that it includes by
// `use:` (core/config.h) inserted. The text is to be written to a file in `folder`: relative paths
// in entries whose key is one of `path_keys`, at any depth, are rewritten relative to it. A change
// to an absent entry adds the entry and the mappings that contain it. Comments are not preserved.
// Throws InputError for an invalid file, like Config::Load, and for an invalid change, with the
// message "field: …".
std::string ChangedYaml(const std::filesystem::path& file, const std::vector<YamlChange>& changes,
                        const std::set<std::string>& path_keys,
                        const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_CORE_CHANGED_YAML_H_
