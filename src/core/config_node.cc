#include "core/config_node.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <cctype>
#include <stdexcept>
#include <utility>

#include "core/error.h"
#include "core/field_path.h"
#include "core/suggestion.h"

namespace lacuna {

std::string ConfigNode::Field(const std::string& key) const {
  return key.empty() ? path : EntryOf(path, key);
}

YAML::Node ConfigNode::Find(const std::string& key) const {
  const YAML::Node entry = std::as_const(*yaml)[key];
  return entry && !entry.IsNull() ? entry : YAML::Node(YAML::NodeType::Undefined);
}

YAML::Node ConfigNode::Required(const std::string& key, const std::string& expected) const {
  const YAML::Node entry = Find(key);
  if (!entry) {
    std::vector<std::string> given;
    for (const auto& pair : *yaml) given.push_back(pair.first.Scalar());
    const std::string misspelled = Nearest(key, given, 2);
    const std::string hint = misspelled.empty() || misspelled == key || Asked(misspelled)
                                 ? ""
                                 : fmt::format(" (\"{}\" is not a known key)", misspelled);
    Fail(yaml->Mark(), Field(key), "is missing" + hint + "; expected " + expected);
  }
  return entry;
}

std::string ConfigNode::Scalar(const YAML::Node& entry, const std::string& field,
                               const std::string& expected) const {
  if (!entry.IsScalar()) {
    Fail(entry.Mark(), field,
         fmt::format("got a {}; expected {}", entry.IsMap() ? "mapping" : "list", expected));
  }
  return entry.Scalar();
}

std::string ConfigNode::DecimalCommaHint(const std::string& key, const Dimension* expected) const {
  for (auto entry = yaml->begin(); entry != yaml->end(); ++entry) {
    if (entry->first.Scalar() != key) continue;
    const YAML::Node value = entry->second;
    if (!value.IsScalar() || ++entry == yaml->end() || !entry->second.IsNull()) return "";
    const std::string decimals = entry->first.Scalar();
    if (decimals.empty() || std::isdigit(static_cast<unsigned char>(decimals.front())) == 0)
      return "";
    const std::string meant = value.Scalar() + "." + decimals;
    try {
      expected != nullptr ? ParseQuantity(meant, *expected) : ParseAnyQuantity(meant).value;
    } catch (const std::invalid_argument&) {
      return "";
    }
    return "; " + DecimalCommaText(meant);
  }
  return "";
}

void ConfigNode::Fail(const YAML::Mark& mark, const std::string& field,
                      const std::string& message) const {
  throw InputError(PositionOf(document->FileOf(field), mark),
                   field.empty() ? message : field + ": " + message);
}

}  // namespace lacuna
