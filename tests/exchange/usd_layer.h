// A small reader of USD's text format for the tests: metadata, prims, attributes with defaults or
// time samples, and relationships; no references, variants or dictionaries.
#ifndef LACUNA_TESTS_EXCHANGE_USD_LAYER_H_
#define LACUNA_TESTS_EXCHANGE_USD_LAYER_H_

#include <map>
#include <string>
#include <vector>

namespace lacuna {

struct UsdValue {
  enum class Kind { kNumber, kText, kPath, kTuple, kArray, kSamples };
  Kind kind = Kind::kNumber;
  double number = 0;
  std::string text;             // of a text or a path
  std::vector<UsdValue> items;  // of a tuple or an array, or one for each of `times`
  std::vector<double> times;

  // The numbers of an array of numbers or of tuples, in the order of the file.
  std::vector<double> Numbers() const;
  std::vector<std::string> Texts() const;
};

struct UsdProperty {
  std::string type;  // "point3f[]", "rel"
  std::string name;
  bool is_uniform = false, is_custom = false;
  UsdValue value;
};

struct UsdPrim {
  std::string type, name, path;
  std::map<std::string, UsdValue> metadata;
  std::vector<UsdProperty> properties;
  std::vector<UsdPrim> children;

  // The property of this name, or null.
  const UsdProperty* Find(const std::string& property) const;
  // The text of a property, or "".
  std::string Text(const std::string& property) const;
  bool Has(const std::string& api_schema) const;
};

struct UsdLayer {
  std::map<std::string, UsdValue> metadata;
  std::vector<UsdPrim> prims;

  // Every prim, a parent before its children.
  std::vector<const UsdPrim*> All() const;
  // The prim at a path such as "/lacuna/body", or null.
  const UsdPrim* Find(const std::string& path) const;
};

// Throws std::runtime_error where the text cannot be read: another header than "#usda 1.0", a
// bracket that is not closed, a name that stands twice.
UsdLayer ReadUsd(const std::string& text);

}  // namespace lacuna

#endif  // LACUNA_TESTS_EXCHANGE_USD_LAYER_H_
