// One mapping of a YAML file with the values that have been read from it, the state of a Config.
#ifndef LACUNA_CORE_CONFIG_NODE_H_
#define LACUNA_CORE_CONFIG_NODE_H_

#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "core/quantity.h"
#include "core/yaml_document.h"

namespace YAML {
class Node;
struct Mark;
}  // namespace YAML

namespace lacuna {

// Private to config.cc and config_values.cc.
struct ConfigNode {
  std::shared_ptr<const YamlDocument> document;
  std::shared_ptr<YAML::Node> yaml;              // the mapping itself, never null
  std::string path;                              // e.g. "effects[1]"; empty at the top level
  std::map<std::string, nlohmann::json> values;  // scalars and lists of scalars read so far, in SI
  std::map<std::string, std::vector<std::shared_ptr<ConfigNode>>> children;  // mappings read so far
  std::map<std::string, bool> is_list;  // the children whose key holds a list of mappings

  // Whether any read has requested `key`, even if the file does not contain it.
  bool Asked(const std::string& key) const { return values.count(key) || children.count(key); }

  // The full name of `key` for messages: "effects[1].eta".
  std::string Field(const std::string& key) const;

  // The entry of `key`; an undefined node if it is absent or null.
  YAML::Node Find(const std::string& key) const;

  // The entry of `key`. Throws InputError with `expected` if it is absent or null; the message
  // mentions an unread key with a similar name, which may be misspelled.
  YAML::Node Required(const std::string& key, const std::string& expected) const;

  // The text of a scalar entry. Throws InputError with `expected` if it is a mapping or a list.
  std::string Scalar(const YAML::Node& entry, const std::string& field,
                     const std::string& expected) const;

  // What to add to a message where a decimal comma has split the quantity at `key`: YAML reads
  // "{young_modulus: 0,2 MPa}" as the number 0 and a key "2 MPa" without a value. Empty where both
  // do not make a quantity, of the dimension `expected` unless that is null.
  std::string DecimalCommaHint(const std::string& key, const Dimension* expected) const;

  // Throws InputError "file:line:column: field: message" with the file that `field` was read from.
  [[noreturn]] void Fail(const YAML::Mark& mark, const std::string& field,
                         const std::string& message) const;
};

}  // namespace lacuna

#endif  // LACUNA_CORE_CONFIG_NODE_H_
