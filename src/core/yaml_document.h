// The YAML document behind a Config: parsed, checked for repeated keys, and with the pieces that it
// includes by `use` inserted. Private to core.
#ifndef LACUNA_CORE_YAML_DOCUMENT_H_
#define LACUNA_CORE_YAML_DOCUMENT_H_

#include <filesystem>
#include <map>
#include <memory>
#include <string>

namespace YAML {
class Node;
}

namespace lacuna {

struct YamlDocument {
  std::filesystem::path file;
  std::shared_ptr<YAML::Node> root;  // a mapping
  // The fields ("scanner.noise") that another file has contributed by `use`, with that file.
  std::map<std::string, std::filesystem::path> file_of_field;

  // The file that `field`, or the innermost listed mapping around it, was read from.
  const std::filesystem::path& FileOf(std::string field) const;
};

// Parses `text`; `file` names it in messages and is the base of relative paths. `use: piece.yaml`
// in a mapping (a path relative to the file that says so) inserts those entries of the piece that
// the mapping does not give itself. Throws InputError if the text is not valid YAML, is not a
// mapping, has a second document or a repeated key, and if a piece is absent or includes itself.
YamlDocument ParseYaml(const std::string& text, const std::filesystem::path& file);

// `text` with "${NAME}" replaced by the environment variable NAME. "${NAME:-value}" falls back to
// `value`. If a variable without a fallback is not set, its name is stored in `*missing`.
std::string ExpandEnvironment(const std::string& text, std::string* missing);

}  // namespace lacuna

#endif  // LACUNA_CORE_YAML_DOCUMENT_H_
