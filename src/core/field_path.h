// Names of fields in YAML and JSON documents, such as effects[1].eta.
#ifndef LACUNA_CORE_FIELD_PATH_H_
#define LACUNA_CORE_FIELD_PATH_H_

#include <string>
#include <string_view>

namespace lacuna {

// The name of the entry `key` of the mapping `field`, which is empty for the whole document.
inline std::string EntryOf(const std::string& field, const std::string& key) {
  return field.empty() ? key : field + "." + key;
}

// Whether `field` is `outer`, which is not empty, or lies in the mapping or list of that name.
inline bool LiesWithin(std::string_view field, std::string_view outer) {
  if (!field.starts_with(outer)) return false;
  return field.size() == outer.size() || field[outer.size()] == '.' || field[outer.size()] == '[';
}

}  // namespace lacuna

#endif  // LACUNA_CORE_FIELD_PATH_H_
