#include "core/config.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <nlohmann/json.hpp>

#include "core/config_node.h"
#include "core/suggestion.h"
#include "core/text_file.h"

namespace lacuna {

Config::Config(std::shared_ptr<ConfigNode> node) : node_(std::move(node)) {}

Config Config::Load(const std::filesystem::path& file) {
  return Parse(ReadWholeFile(file), file.string());
}

Config Config::Parse(const std::string& text, const std::string& name) {
  auto node = std::make_shared<ConfigNode>();
  node->document = std::make_shared<const YamlDocument>(ParseYaml(text, name));
  node->yaml = node->document->root;
  return Config(node);
}

bool Config::Has(const std::string& key) const { return static_cast<bool>(node_->Find(key)); }

std::vector<std::string> Config::Keys() const {
  std::vector<std::string> keys;
  for (const auto& entry : *node_->yaml) keys.push_back(entry.first.Scalar());
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
  auto child = std::make_shared<ConfigNode>();
  child->document = node_->document;
  child->yaml = std::make_shared<YAML::Node>(entry);
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
    std::vector<std::shared_ptr<ConfigNode>> nodes;
    if (const YAML::Node entry = node_->Find(key)) {
      if (!entry.IsSequence()) {
        node_->Fail(entry.Mark(), node_->Field(key),
                    "expected a list whose items begin with \"- \"");
      }
      for (const auto& item : entry) {
        auto child = std::make_shared<ConfigNode>();
        child->document = node_->document;
        child->yaml = std::make_shared<YAML::Node>(static_cast<const YAML::Node&>(item));
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
  std::string before;  // the key of the last entry
  for (const auto& entry : *node_->yaml) {
    const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
    if (!node_->Asked(key)) {
      const std::string comma = node_->DecimalCommaHint(before, /*expected=*/nullptr);
      node_->Fail(entry.first.Mark(), node_->Field(key),
                  "unknown key" + (comma.empty() ? Suggestion(key, known) : comma));
    }
    before = key;
  }
  for (const auto& [key, children] : node_->children)
    for (const auto& child : children) Config(child).RefuseUnknownKeys();
}

void Config::Fail(const std::string& key, const std::string& message) const {
  const YAML::Node entry = key.empty() ? *node_->yaml : node_->Find(key);
  node_->Fail(entry ? entry.Mark() : node_->yaml->Mark(), node_->Field(key), message);
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
