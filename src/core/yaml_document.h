// The YAML document that a Config reads: parsed, checked for repeated keys, and with the pieces
// that it includes by `use` inserted. Private to core.
#ifndef LACUNA_CORE_YAML_DOCUMENT_H_
#define LACUNA_CORE_YAML_DOCUMENT_H_

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "core/error.h"

namespace YAML {
class Node;
struct Mark;
}  // namespace YAML

namespace lacuna {

struct YamlDocument {
  std::filesystem::path file;
  std::shared_ptr<YAML::Node> root;  // a mapping
  // The file of each field ("scanner.noise") that has been inserted from another file by `use`.
  std::map<std::string, std::filesystem::path> file_of_field;

  // The file that `field` was read from: the one listed for it or for the innermost mapping that
  // contains it, otherwise the main file.
  const std::filesystem::path& FileOf(std::string field) const;
};

// The position of `mark` in `file`; the file as a whole for a null mark.
SourcePosition PositionOf(const std::filesystem::path& file, const YAML::Mark& mark);

// Parses `text`. `file` is used as its name in messages and as the base of relative paths. An entry
// `use: piece.yaml` in a mapping (a path relative to the file that contains it) inserts those
// entries of the piece that the mapping does not contain itself. Throws InputError if the text is
// not valid YAML, is not a mapping, or contains a second document or a repeated key, and if a piece
// is absent or includes itself.
YamlDocument ParseYaml(const std::string& text, const std::filesystem::path& file);

// `text` with "${NAME}" replaced by the value of the environment variable NAME. "${NAME:-value}" is
// replaced by `value` if the variable is unset or empty. If a variable without such a value is
// unset or empty, its name is stored in `*missing`.
std::string ExpandEnvironment(const std::string& text, std::string* missing);

}  // namespace lacuna

#endif  // LACUNA_CORE_YAML_DOCUMENT_H_
