// The YAML behind a Config: read whole, checked for what YAML itself allows but loses, and with the
// pieces it uses put in. Private to config.cc.
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
  std::shared_ptr<YAML::Node> root;
  // Fields ("scanner.noise") that came from another file, by `use`.
  std::map<std::string, std::filesystem::path> file_of_field;

  // The file that a field, or the mapping it is in, was read from.
  const std::filesystem::path& FileOf(std::string field) const;
};

// Throws InputError for what is not YAML, no mapping, a second document, a key given twice, and for
// pieces that are not there or use one another in a circle.
//
// `use: piece.yaml` in a mapping (a path relative to the file it stands in) puts in the piece's
// entries that the mapping does not give itself.
YamlDocument ParseYaml(const std::string& text, const std::filesystem::path& file);

// "${NAME}" replaced by the environment variable of that name, "${NAME:-value}" falling back to
// `value`; a variable that is not set becomes `*missing`.
std::string ExpandEnvironment(const std::string& text, std::string* missing);

}  // namespace lacuna

#endif  // LACUNA_CORE_YAML_DOCUMENT_H_
