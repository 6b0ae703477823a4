#include "core/config.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>

#include "core/suggestion.h"
#include "core/text_file.h"
#include "core/yaml_document.h"

namespace lacuna {

// One mapping of the file and what has been read from it.
struct Config::Node {
  std::shared_ptr<const YamlDocument> document;
  YAML::Node yaml;
  std::string path;                              // "effects[1]", empty at the top
  std::map<std::string, nlohmann::json> values;  // leaves read, in SI
  std::map<std::string, std::vector<std::shared_ptr<Node>>> children;  // mappings and lists read
  std::map<std::string, bool> is_list;

  bool Asked(const std::string& key) const { return values.count(key) || children.count(key); }

  std::string Field(const std::string& key) const {
    if (key.empty()) return path;
    return path.empty() ? key : path + "." + key;
  }
  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& field,
                         const std::string& message) const {
    SourcePosition position{document->FileOf(field).string()};
    if (!mark.is_null()) {
      position.line = mark.line + 1;
      position.column = mark.column + 1;
    }
    throw InputError(position, field.empty() ? message : field + ": " + message);
  }
  // The entry of `key`; an undefined node where there is none or it is null.
  YAML::Node Find(const std::string& key) const {
    const YAML::Node entry = std::as_const(yaml)[key];
    return entry && !entry.IsNull() ? entry : YAML::Node(YAML::NodeType::Undefined);
  }
  YAML::Node Required(const std::string& key, const std::string& expected) const {
    const YAML::Node entry = Find(key);
    if (!entry) {
      std::vector<std::string> given;
      for (const auto& pair : yaml) given.push_back(pair.first.Scalar());
      const std::string misspelled = Nearest(key, given, 2);
      const std::string hint = misspelled.empty() || misspelled == key || Asked(misspelled)
                                   ? ""
                                   : fmt::format(" (\"{}\" is no key)", misspelled);
      Fail(yaml.Mark(), Field(key), "is missing" + hint + "; expected " + expected);
    }
    return entry;
  }
  std::string Scalar(const YAML::Node& entry, const std::string& field,
                     const std::string& expected) const {
    if (!entry.IsScalar()) {
      Fail(entry.Mark(), field,
           fmt::format("got a {}; expected {}", entry.IsMap() ? "mapping" : "list", expected));
    }
    return entry.Scalar();
  }
};

namespace {

constexpr int kMaxListLength = 10'000'000;

std::string Describe(const Bounds& bounds, const std::string& unit) {
  const auto number = [&](double value) {
    return unit.empty() || value == 0 ? fmt::format("{:g}", value)
                                      : fmt::format("{:g} {}", value, unit);
  };
  if (std::isfinite(bounds.min) && std::isfinite(bounds.max)) {
    return fmt::format(" in {}{}, {}{}", bounds.open_min ? "(" : "[", number(bounds.min),
                       number(bounds.max), bounds.open_max ? ")" : "]");
  }
  if (std::isfinite(bounds.min))
    return fmt::format(" {} {}", bounds.open_min ? ">" : "≥", number(bounds.min));
  if (std::isfinite(bounds.max))
    return fmt::format(" {} {}", bounds.open_max ? "<" : "≤", number(bounds.max));
  return "";
}

bool Inside(const Bounds& bounds, double value) {
  return (bounds.open_min ? value > bounds.min : value >= bounds.min) &&
         (bounds.open_max ? value < bounds.max : value <= bounds.max);
}

}  // namespace

Config::Config(std::shared_ptr<Node> node) : node_(std::move(node)) {}

Config Config::Load(const std::filesystem::path& file) {
  return Parse(ReadWholeFile(file), file.string());
}

Config Config::Parse(const std::string& text, const std::string& name) {
  auto node = std::make_shared<Node>();
  node->document = std::make_shared<const YamlDocument>(ParseYaml(text, name));
  node->yaml.reset(*node->document->root);
  return Config(node);
}

namespace {

double ReadQuantity(const std::string& text, const Dimension& dimension, const Bounds& bounds) {
  const double value = ParseQuantity(text, dimension);
  if (!Inside(bounds, value)) {
    throw std::invalid_argument(fmt::format("got \"{}\"; expected {}{}", text, dimension.name,
                                            Describe(bounds, dimension.unit)));
  }
  return value;
}

}  // namespace

double Config::Quantity(const std::string& key, const Dimension& dimension,
                        const Bounds& bounds) const {
  const std::string expected = fmt::format("{}{}, e.g. \"{}\"", dimension.name,
                                           Describe(bounds, dimension.unit), dimension.example);
  const YAML::Node entry = node_->Required(key, expected);
  const std::string text = node_->Scalar(entry, node_->Field(key), expected);
  try {
    const double value = ReadQuantity(text, dimension, bounds);
    node_->values[key] = value;
    return value;
  } catch (const std::invalid_argument& problem) {
    node_->Fail(entry.Mark(), node_->Field(key), problem.what());
  }
}

double Config::Quantity(const std::string& key, const Dimension& dimension, const Bounds& bounds,
                        double default_value) const {
  if (Has(key)) return Quantity(key, dimension, bounds);
  node_->values[key] = default_value;
  return default_value;
}

MeasuredQuantity Config::AnyQuantity(const std::string& key) const {
  const std::string expected = "a number with its unit, e.g. \"3 N/kg\"";
  const YAML::Node entry = node_->Required(key, expected);
  try {
    const MeasuredQuantity quantity =
        ParseAnyQuantity(node_->Scalar(entry, node_->Field(key), expected));
    node_->values[key] = quantity.value;
    return quantity;
  } catch (const std::invalid_argument& problem) {
    node_->Fail(entry.Mark(), node_->Field(key), problem.what());
  }
}

double Config::Number(const std::string& key, const Bounds& bounds) const {
  return Quantity(key, kDimensionless, bounds);
}

double Config::Number(const std::string& key, const Bounds& bounds, double default_value) const {
  return Quantity(key, kDimensionless, bounds, default_value);
}

namespace {

int ToInteger(const std::string& text, int min, int max) {
  const std::string expected = max == std::numeric_limits<int>::max()
                                   ? fmt::format("a whole number ≥ {}", min)
                                   : fmt::format("a whole number from {} to {}", min, max);
  size_t used = 0;
  long long value = 0;
  try {
    value = std::stoll(text, &used);
  } catch (const std::exception&) {
    used = 0;
  }
  if (used == 0 || used != text.size() || value < min || value > max)
    throw std::invalid_argument(fmt::format("got \"{}\"; expected {}", text, expected));
  return static_cast<int>(value);
}

}  // namespace

int Config::Integer(const std::string& key, int min, int max) const {
  const YAML::Node entry = node_->Required(key, "a whole number");
  const std::string text = node_->Scalar(entry, node_->Field(key), "a whole number");
  try {
    const int value = ToInteger(text, min, max);
    node_->values[key] = value;
    return value;
  } catch (const std::invalid_argument& problem) {
    node_->Fail(entry.Mark(), node_->Field(key), problem.what());
  }
}

int Config::Integer(const std::string& key, int min, int max, int default_value) const {
  if (Has(key)) return Integer(key, min, max);
  node_->values[key] = default_value;
  return default_value;
}

bool Config::Flag(const std::string& key, bool default_value) const {
  bool value = default_value;
  if (const YAML::Node entry = node_->Find(key)) {
    if (!YAML::convert<bool>::decode(entry, value)) {
      node_->Fail(entry.Mark(), node_->Field(key),
                  fmt::format("got \"{}\"; expected true or false",
                              entry.IsScalar() ? entry.Scalar() : "a list or mapping"));
    }
  }
  node_->values[key] = value;
  return value;
}

std::string Config::Text(const std::string& key) const {
  const YAML::Node entry = node_->Required(key, "a text");
  const std::string text = node_->Scalar(entry, node_->Field(key), "a text");
  node_->values[key] = text;
  return text;
}

std::string Config::Text(const std::string& key, const std::string& default_value) const {
  if (Has(key)) return Text(key);
  node_->values[key] = default_value;
  return default_value;
}

std::vector<std::string> Config::Texts(const std::string& key) const {
  std::vector<std::string> texts;
  if (const YAML::Node entry = node_->Find(key)) {
    if (entry.IsScalar()) {
      texts.push_back(entry.Scalar());
    } else if (entry.IsSequence()) {
      for (const auto& item : entry)
        texts.push_back(node_->Scalar(item, node_->Field(key), "a text"));
    } else {
      node_->Fail(entry.Mark(), node_->Field(key), "got a mapping; expected a text or a list");
    }
  }
  node_->values[key] = texts;
  return texts;
}

std::vector<int> Config::Integers(const std::string& key, int min) const {
  std::vector<int> values;
  if (const YAML::Node entry = node_->Find(key)) {
    if (!entry.IsSequence()) {
      node_->Fail(entry.Mark(), node_->Field(key), "expected a list of whole numbers, e.g. [0, 4]");
    }
    for (const auto& item : entry) {
      const std::string field = fmt::format("{}[{}]", node_->Field(key), values.size());
      try {
        values.push_back(ToInteger(node_->Scalar(item, field, "a whole number"), min,
                                   std::numeric_limits<int>::max()));
      } catch (const std::invalid_argument& problem) {
        node_->Fail(item.Mark(), field, problem.what());
      }
    }
  }
  node_->values[key] = values;
  return values;
}

std::vector<double> Config::Quantities(const std::string& key, const Dimension& dimension,
                                       const Bounds& bounds) const {
  std::vector<double> values;
  if (const YAML::Node entry = node_->Find(key)) {
    const std::string expected = fmt::format("a list of entries like \"{}\"", dimension.example);
    if (!entry.IsSequence()) node_->Fail(entry.Mark(), node_->Field(key), "expected " + expected);
    if (entry.size() > kMaxListLength) node_->Fail(entry.Mark(), node_->Field(key), "is too long");
    for (const auto& item : entry) {
      const std::string field = fmt::format("{}[{}]", node_->Field(key), values.size());
      const std::string text = node_->Scalar(item, field, dimension.name);
      try {
        // A bare zero means the same in every unit.
        values.push_back(text == "0" || text == "0.0" ? 0.0
                                                      : ReadQuantity(text, dimension, bounds));
      } catch (const std::invalid_argument& problem) {
        node_->Fail(item.Mark(), field, problem.what());
      }
    }
  }
  node_->values[key] = values;
  return values;
}

Eigen::Vector3d Config::Vector(const std::string& key, const Dimension& dimension) const {
  const YAML::Node entry =
      node_->Required(key, fmt::format("three entries, e.g. [0, 0, {}]", dimension.example));
  const std::vector<double> values = Quantities(key, dimension, kAnyValue);
  if (values.size() != 3) {
    node_->Fail(entry.Mark(), node_->Field(key),
                fmt::format("got {} entries; expected three, e.g. [0, 0, {}]", values.size(),
                            dimension.example));
  }
  return {values[0], values[1], values[2]};
}

Eigen::Vector3d Config::Vector(const std::string& key, const Dimension& dimension,
                               const Eigen::Vector3d& default_value) const {
  if (Has(key)) return Vector(key, dimension);
  node_->values[key] = {default_value[0], default_value[1], default_value[2]};
  return default_value;
}

std::filesystem::path Config::Path(const std::string& key) const {
  const YAML::Node entry = node_->Required(key, "a path");
  std::string missing;
  const std::filesystem::path path =
      ExpandEnvironment(node_->Scalar(entry, node_->Field(key), "a path"), &missing);
  if (!missing.empty()) {
    node_->Fail(entry.Mark(), node_->Field(key),
                fmt::format("the environment variable {} is not set", missing));
  }
  node_->values[key] = entry.Scalar();
  const std::filesystem::path& file = node_->document->FileOf(node_->Field(key));
  return path.is_absolute() ? path : (file.parent_path() / path).lexically_normal();
}

std::filesystem::path Config::Path(const std::string& key, const std::string& default_value) const {
  if (Has(key)) return Path(key);
  node_->values[key] = default_value;
  if (default_value.empty()) return {};
  return (File().parent_path() / default_value).lexically_normal();
}

size_t Config::ChoiceIndex(const std::string& key, const std::vector<std::string>& names,
                           const std::optional<std::string>& default_name) const {
  const std::string expected = fmt::format("one of: {}", fmt::join(names, ", "));
  const std::string name = default_name && !Has(key) ? *default_name
                                                     : node_->Scalar(node_->Required(key, expected),
                                                                     node_->Field(key), expected);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found == names.end()) {
    Fail(key, fmt::format("got \"{}\"; expected {}{}", name, expected, Suggestion(name, names)));
  }
  node_->values[key] = name;
  return static_cast<size_t>(found - names.begin());
}

bool Config::Has(const std::string& key) const { return static_cast<bool>(node_->Find(key)); }

std::vector<std::string> Config::Keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : node_->yaml) keys.push_back(entry.first.Scalar());
  return keys;
}

std::optional<Config> Config::OptionalChild(const std::string& key) const {
  if (node_->children.count(key)) {
    const auto& known = node_->children[key];
    return known.empty() ? std::nullopt : std::optional<Config>(Config(known.front()));
  }
  const YAML::Node entry = node_->Find(key);
  if (!entry) {
    node_->children[key] = {};
    return std::nullopt;
  }
  if (!entry.IsMap()) node_->Fail(entry.Mark(), node_->Field(key), "expected a mapping");
  auto child = std::make_shared<Node>();
  child->document = node_->document;
  child->yaml.reset(entry);
  child->path = node_->Field(key);
  node_->children[key] = {child};
  return Config(child);
}

Config Config::Child(const std::string& key) const {
  node_->Required(key, "a mapping");
  return *OptionalChild(key);
}

std::vector<Config> Config::Items(const std::string& key) const {
  std::vector<Config> items;
  if (!node_->children.count(key)) {
    std::vector<std::shared_ptr<Node>> nodes;
    if (const YAML::Node entry = node_->Find(key)) {
      if (!entry.IsSequence()) {
        node_->Fail(entry.Mark(), node_->Field(key), "expected a list, each item after a \"- \"");
      }
      for (const auto& item : entry) {
        auto child = std::make_shared<Node>();
        child->document = node_->document;
        child->yaml.reset(static_cast<const YAML::Node&>(item));
        child->path = fmt::format("{}[{}]", node_->Field(key), nodes.size());
        if (!item.IsMap()) node_->Fail(item.Mark(), child->path, "expected a mapping");
        nodes.push_back(child);
      }
    }
    node_->children[key] = nodes;
    node_->is_list[key] = true;
  }
  for (const auto& child : node_->children[key]) items.push_back(Config(child));
  return items;
}

void Config::RefuseUnknownKeys() const {
  std::vector<std::string> known;
  for (const auto& [key, value] : node_->values) known.push_back(key);
  for (const auto& [key, value] : node_->children) known.push_back(key);
  for (const auto& entry : node_->yaml) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (node_->Asked(key)) continue;
    node_->Fail(entry.first.Mark(), node_->Field(key),
                fmt::format("unknown key{}", Suggestion(key, known)));
  }
  for (const auto& [key, children] : node_->children)
    for (const auto& child : children) Config(child).RefuseUnknownKeys();
}

void Config::Fail(const std::string& key, const std::string& message) const {
  const YAML::Node entry = key.empty() ? node_->yaml : node_->Find(key);
  node_->Fail(entry ? entry.Mark() : node_->yaml.Mark(), node_->Field(key), message);
}

void Config::FailAtItem(const std::string& key, size_t item, const std::string& message) const {
  const YAML::Node entry = node_->Find(key);
  if (!entry || !entry.IsSequence() || item >= entry.size()) Fail(key, message);
  node_->Fail(entry[item].Mark(), fmt::format("{}[{}]", node_->Field(key), item), message);
}

std::filesystem::path Config::File() const { return node_->document->file; }

nlohmann::json Config::Resolved() const {
  nlohmann::json resolved = nlohmann::json::object();
  for (const auto& [key, value] : node_->values) resolved[key] = value;
  for (const auto& [key, children] : node_->children) {
    if (node_->is_list.count(key)) {
      resolved[key] = nlohmann::json::array();
      for (const auto& child : children) resolved[key].push_back(Config(child).Resolved());
    } else if (!children.empty()) {
      resolved[key] = Config(children.front()).Resolved();
    }
  }
  return resolved;
}

}  // namespace lacuna
