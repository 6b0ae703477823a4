// Structs of a std::variant as JSON objects, distinguished by the key "kind".
//
// For each alternative there is a function template in namespace lacuna,
//   template <typename Visitor> void VisitFields(Visitor& visit, Alternative& value) {
//     visit.Kind("its_name");
//     visit("key", value.field);
//   }
// which serves both directions. Fields are numbers, booleans, strings, lists of strings, and
// Eigen::Vector3d.
#ifndef LACUNA_RECORD_TAGGED_JSON_H_
#define LACUNA_RECORD_TAGGED_JSON_H_

#include <Eigen/Core>
#include <nlohmann/json.hpp>
#include <string>
#include <variant>

#include "core/error.h"
#include "core/json_number.h"

namespace lacuna {

class FieldWriter {
 public:
  explicit FieldWriter(nlohmann::json* object) : object_(*object) {}
  void Kind(const char* name) { object_["kind"] = name; }
  void operator()(const char* key, double value) { object_[key] = NumberOrNull(value); }
  void operator()(const char* key, const Eigen::Vector3d& value) {
    object_[key] = {value[0], value[1], value[2]};
  }
  template <typename Value>
  void operator()(const char* key, const Value& value) {
    object_[key] = value;
  }

 private:
  nlohmann::json& object_;
};

// Reads the fields of an object, unless it is of another kind.
class FieldReader {
 public:
  explicit FieldReader(const nlohmann::json& object) : object_(object) {}
  bool matches() const { return matches_; }
  void Kind(const char* name) { matches_ = object_.at("kind") == name; }
  void operator()(const char* key, double& value) {
    if (matches_) value = NumberOr(object_.at(key));
  }
  void operator()(const char* key, Eigen::Vector3d& value) {
    for (int axis = 0; axis < 3 && matches_; ++axis)
      value[axis] = object_.at(key).at(static_cast<size_t>(axis)).get<double>();
  }
  template <typename Value>
  void operator()(const char* key, Value& value) {
    if (matches_) value = object_.at(key).get<Value>();
  }

 private:
  const nlohmann::json& object_;
  bool matches_ = false;
};

template <typename Variant>
nlohmann::json TaggedToJson(Variant value) {
  nlohmann::json object;
  FieldWriter writer(&object);
  std::visit([&](auto& alternative) { VisitFields(writer, alternative); }, value);
  return object;
}

// Throws nlohmann::json::exception, and InputError when the kind is none of the variant's.
template <typename Variant, size_t kIndex = 0>
Variant TaggedFromJson(const nlohmann::json& object) {
  if constexpr (kIndex == std::variant_size_v<Variant>) {
    throw InputError("unknown kind " + object.at("kind").dump());
  } else {
    std::variant_alternative_t<kIndex, Variant> alternative;
    FieldReader reader(object);
    VisitFields(reader, alternative);
    if (reader.matches()) return alternative;
    return TaggedFromJson<Variant, kIndex + 1>(object);
  }
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_TAGGED_JSON_H_
