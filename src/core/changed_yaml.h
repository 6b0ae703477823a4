// A YAML file with other values in it, as a file that stands for itself.
#ifndef LACUNA_CORE_CHANGED_YAML_H_
#define LACUNA_CORE_CHANGED_YAML_H_

#include <filesystem>
#include <set>
#include <string>
#include <vector>

namespace lacuna {

struct YamlChange {
  std::string field;           // "mesh.max_volume", "effects[0].eta"
  std::string value;           // YAML: "150 mm^3", "[0, 0, 1 N]"; "~" takes the entry out
  std::filesystem::path file;  // where the change is written down: relative paths start there
};

// The file's YAML with the changes and all the pieces that it uses (core/config.h), to be written
// into `folder`: the relative paths at `path_keys` (names of entries, wherever they stand) are
// rewritten to start there. Entries that the file does not have are added, mappings above them
// made. Comments are lost. Throws InputError: for a file as Config::Load does, for a change with
// "field: message".
std::string ChangedYaml(const std::filesystem::path& file, const std::vector<YamlChange>& changes,
                        const std::set<std::string>& path_keys,
                        const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_CORE_CHANGED_YAML_H_
