#include "core/changed_yaml.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <optional>
#include <string_view>
#include <utility>

#include "core/error.h"
#include "core/field_path.h"
#include "core/parsed_word.h"
#include "core/text_file.h"
#include "core/yaml_document.h"

namespace lacuna {
namespace {

// Splits "effects[0].eta" into effects, [0 and eta. Empty if `field` is not a valid field name.
std::vector<std::string> StepsOf(const std::string& field) {
  std::vector<std::string> steps;
  size_t at = 0;
  while (at < field.size()) {
    const bool index = field[at] == '[';
    const size_t end = std::min(field.find_first_of(index ? "]" : ".[", at), field.size());
    if (end == at || (index && end == field.size())) return {};
    steps.push_back(field.substr(at, end - at));
    at = end + (index ? 1 : 0);
    if (at < field.size() && field[at] == '.' && ++at == field.size()) return {};
  }
  return steps;
}

// The number of places at which a mapping or list occurs in the tree. It is greater than 1 if an
// alias refers to the mapping or list.
int Occurrences(const YAML::Node& tree, const YAML::Node& wanted) {
  if (tree.is(wanted)) return 1;
  int count = 0;
  if (tree.IsMap())
    for (const auto& entry : tree) count += Occurrences(entry.second, wanted);
  if (tree.IsSequence())
    for (const auto& item : tree) count += Occurrences(item, wanted);
  return count;
}

// The index in a step such as "[3"; std::nullopt if it is not the index of an item of the list.
std::optional<size_t> IndexIn(const YAML::Node& list, const std::string& step) {
  const auto index = ParseWord<size_t>(std::string_view(step).substr(1));
  return index && list.IsSequence() && *index < list.size() ? index : std::nullopt;
}

// Sets or removes one entry of a tree.
class Change {
 public:
  Change(const std::string& field, const YAML::Node& root) : field_(field), root_(root) {}

  // Returns the name of the field: with the index of an item that was added.
  std::string Put(const YAML::Node& value) {
    const std::vector<std::string> steps = StepsOf(field_);
    if (steps.empty()) Fail("is not a field name; expected e.g. mesh.max_volume or effects[0].eta");
    YAML::Node at;
    at.reset(root_);
    for (size_t k = 0; k + 1 < steps.size(); ++k) at.reset(Below(at, steps[k]));
    const std::string& last = steps.back();
    if (last == "[+") {
      if (!at.IsSequence()) Fail(path_ + " is not a list");
      at.push_back(value);
      return fmt::format("{}[{}]", field_.substr(0, field_.size() - 3), at.size() - 1);
    }
    if (last[0] == '[') {
      const auto index = IndexIn(at, last);
      if (!index) Fail(path_ + " has no item " + last + "]");
      at[*index] = value;
      return field_;
    }
    if (!at.IsMap()) Fail(path_ + " is not a mapping");
    at.remove(last);
    if (!value.IsNull()) at.force_insert(last, value);
    return field_;
  }

 private:
  // Returns the entry or item `step` of `at`. An absent entry is created as an empty mapping.
  YAML::Node Below(YAML::Node at, const std::string& step) {
    YAML::Node next;
    if (step[0] == '[') {
      const auto index = IndexIn(at, step);
      if (!index) Fail(path_ + " has no item " + step + "]");
      next.reset(at[*index]);
      path_ += step + "]";
    } else {
      if (!at.IsMap()) Fail(path_ + " is not a mapping");
      path_ = EntryOf(path_, step);
      const YAML::Node found = std::as_const(at)[step];
      if (!found || found.IsNull()) {
        at.remove(step);
        at.force_insert(step, YAML::Node(YAML::NodeType::Map));
      }
      next.reset(at[step]);
    }
    if (Occurrences(root_, next) > 1)
      Fail(path_ +
           " is shared by several places in the file (a YAML alias); replace the alias by a copy");
    return next;
  }

  [[noreturn]] void Fail(const std::string& message) const {
    throw InputError(field_ + ": " + message);
  }

  const std::string& field_;
  const YAML::Node& root_;
  std::string path_;
};

YAML::Node ParseValue(const YamlChange& change) {
  try {
    return YAML::Load(change.value);
  } catch (const YAML::ParserException& problem) {
    throw InputError(
        fmt::format("{}: \"{}\" is not valid YAML: {}", change.field, change.value, problem.msg));
  }
}

// Rewrites the relative paths in a document relative to another folder.
class PathMover {
 public:
  PathMover(const YamlDocument& document, const std::vector<YamlChange>& changes,
            const std::set<std::string>& keys, const std::filesystem::path& folder)
      : document_(document),
        changes_(changes),
        keys_(keys),
        folder_(std::filesystem::weakly_canonical(folder)) {}

  void Move(YAML::Node node, const std::string& field) const {
    if (node.IsSequence())
      for (size_t k = 0; k < node.size(); ++k) Move(node[k], fmt::format("{}[{}]", field, k));
    if (!node.IsMap()) return;
    for (auto entry : node) {
      const std::string key = entry.first.Scalar();
      const std::string below = EntryOf(field, key);
      if (keys_.contains(key) && entry.second.IsScalar()) {
        entry.second = Moved(entry.second.Scalar(), FileOf(below));
      } else {
        Move(entry.second, below);
      }
    }
  }

 private:
  std::filesystem::path FileOf(const std::string& field) const {
    std::filesystem::path file = document_.FileOf(field);
    for (const YamlChange& change : changes_) {
      if (LiesWithin(field, change.field)) file = change.file;
    }
    return file;
  }

  std::string Moved(const std::string& given, const std::filesystem::path& file) const {
    std::string missing;
    const std::filesystem::path path = ExpandEnvironment(given, &missing);
    if (!missing.empty() || path.empty() || path.is_absolute()) return given;
    return std::filesystem::weakly_canonical(file.parent_path() / path)
        .lexically_proximate(folder_)
        .string();
  }

  const YamlDocument& document_;
  const std::vector<YamlChange>& changes_;
  const std::set<std::string>& keys_;
  const std::filesystem::path folder_;
};

}  // namespace

std::string ChangedYaml(const std::filesystem::path& file, const std::vector<YamlChange>& changes,
                        const std::set<std::string>& path_keys,
                        const std::filesystem::path& folder) {
  const YamlDocument document = ParseYaml(ReadWholeFile(file), file.string());
  std::vector<YamlChange> made = changes;
  for (YamlChange& change : made)
    change.field = Change(change.field, *document.root).Put(ParseValue(change));
  PathMover(document, made, path_keys, folder).Move(*document.root, "");
  YAML::Emitter emitter;
  emitter << *document.root;
  return std::string(emitter.c_str()) + "\n";
}

}  // namespace lacuna
