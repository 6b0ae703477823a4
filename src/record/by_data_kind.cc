#include "record/by_data_kind.h"

#include <nlohmann/json.hpp>

namespace lacuna {

nlohmann::json ByDataKindToJson(const ByDataKind& numbers) {
  nlohmann::json value;
  for (const auto& [name, kind] : kDataKinds) value[name] = numbers.*kind;
  return value;
}

ByDataKind ByDataKindFromJson(const nlohmann::json& value) {
  ByDataKind numbers;
  for (const auto& [name, kind] : kDataKinds) numbers.*kind = value.at(name).get<double>();
  return numbers;
}

}  // namespace lacuna
