// A YAML file as a checked, located, unit-aware tree.
//
// Each read names its key, its dimension and its bounds; from these reads alone come the check for
// unknown keys (with the nearest known one), the messages with file:line:column and field, and the
// resolved configuration (all values, defaults included, in SI) that goes into the manifest. There
// is no second description of the schema to keep in step.
//
// `use: ../configs/scanner/four_cameras.yaml` in any mapping puts in that file's entries which the
// mapping does not give itself; what is wrong with them is told with that file's name and line.
#ifndef LACUNA_CORE_CONFIG_H_
#define LACUNA_CORE_CONFIG_H_

#include <Eigen/Core>
#include <filesystem>
#include <limits>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/error.h"
#include "core/quantity.h"

namespace lacuna {

// The values a number may take. Open ends exclude the bound itself.
struct Bounds {
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  bool open_min = false;
  bool open_max = false;
};
inline constexpr Bounds kAnyValue{};
inline constexpr Bounds kPositive{0, std::numeric_limits<double>::infinity(), true, false};
inline constexpr Bounds kNotNegative{0, std::numeric_limits<double>::infinity(), false, false};

// A mapping (or list item) of the file. Copies refer to the same document.
class Config {
 public:
  // Throws InputError when the file is absent, is not YAML, or its top level is not a mapping.
  static Config Load(const std::filesystem::path& file);
  static Config Parse(const std::string& text, const std::string& name);

  // Reads `key` of this mapping. Without a default the key is required. All values SI.
  double Quantity(const std::string& key, const Dimension& dimension, const Bounds& bounds) const;
  double Quantity(const std::string& key, const Dimension& dimension, const Bounds& bounds,
                  double default_value) const;
  // A quantity of whatever dimension its unit has; required.
  MeasuredQuantity AnyQuantity(const std::string& key) const;
  double Number(const std::string& key, const Bounds& bounds) const;
  double Number(const std::string& key, const Bounds& bounds, double default_value) const;
  int Integer(const std::string& key, int min, int max) const;
  int Integer(const std::string& key, int min, int max, int default_value) const;
  bool Flag(const std::string& key, bool default_value) const;
  std::string Text(const std::string& key) const;
  std::string Text(const std::string& key, const std::string& default_value) const;
  std::vector<std::string> Texts(const std::string& key) const;  // a text or a list; absent: empty
  std::vector<int> Integers(const std::string& key, int min) const;  // absent: empty
  // Three quantities: [0, 0, -9.81 m/s^2]; a bare 0 needs no unit.
  Eigen::Vector3d Vector(const std::string& key, const Dimension& dimension) const;
  Eigen::Vector3d Vector(const std::string& key, const Dimension& dimension,
                         const Eigen::Vector3d& default_value) const;
  // A list of any length.
  std::vector<double> Quantities(const std::string& key, const Dimension& dimension,
                                 const Bounds& bounds) const;  // absent: empty
  // A path, taken relative to the folder of this file.
  std::filesystem::path Path(const std::string& key) const;
  std::filesystem::path Path(const std::string& key, const std::string& default_value) const;

  // One of named values; the message lists them.
  template <typename T>
  T Choice(const std::string& key, const std::vector<std::pair<std::string, T>>& choices) const {
    return choices[ChoiceIndex(key, Names(choices), std::nullopt)].second;
  }
  template <typename T>
  T Choice(const std::string& key, const std::vector<std::pair<std::string, T>>& choices,
           const std::string& default_name) const {
    return choices[ChoiceIndex(key, Names(choices), default_name)].second;
  }

  bool Has(const std::string& key) const;
  // All keys of this mapping, in the order of the file.
  std::vector<std::string> Keys() const;
  Config Child(const std::string& key) const;  // required mapping
  std::optional<Config> OptionalChild(const std::string& key) const;
  std::vector<Config> Items(const std::string& key) const;  // a list of mappings; absent: empty

  // Refuses every key, here and below, that no read has asked for. Call when all has been read.
  void RefuseUnknownKeys() const;

  // Throws InputError at `key` (or, with an empty key, at this mapping): "field: message".
  [[noreturn]] void Fail(const std::string& key, const std::string& message) const;
  // The same at an item of the list at `key`.
  [[noreturn]] void FailAtItem(const std::string& key, size_t item,
                               const std::string& message) const;

  std::filesystem::path File() const;
  // Everything read so far, defaults included, in SI.
  nlohmann::json Resolved() const;

 private:
  struct Node;
  explicit Config(std::shared_ptr<Node> node);
  template <typename T>
  static std::vector<std::string> Names(const std::vector<std::pair<std::string, T>>& choices) {
    std::vector<std::string> names;
    for (const auto& choice : choices) names.push_back(choice.first);
    return names;
  }
  size_t ChoiceIndex(const std::string& key, const std::vector<std::string>& names,
                     const std::optional<std::string>& default_name) const;

  std::shared_ptr<Node> node_;
};

}  // namespace lacuna

#endif  // LACUNA_CORE_CONFIG_H_
