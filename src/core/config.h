// Typed reading of a YAML file, with units, bounds and error positions.
//
// Each read states its key, its dimension and its bounds. The reads are the only description of the
// schema. The check for unknown keys (with a suggestion), the error messages with file:line:column
// and field, and the resolved configuration in the manifest (all values in SI units, defaults
// included) are derived from them.
//
// `use: ../configs/scanner/four_cameras.yaml` in a mapping inserts those entries of that file that
// the mapping does not contain itself. Errors in them are reported with that file's name and line.
#ifndef LACUNA_CORE_CONFIG_H_
#define LACUNA_CORE_CONFIG_H_

#include <Eigen/Core>
#include <filesystem>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/bounds.h"
#include "core/error.h"
#include "core/quantity.h"

namespace lacuna {

struct ConfigNode;  // core/config_node.h

// A mapping, or an item of a list of mappings. Copies refer to the same document and share the
// record of what has been read, so a document must not be read by several threads at the same time.
class Config {
 public:
  // Throws InputError if the file is absent, is not valid YAML, or is not a mapping at the top
  // level.
  static Config Load(const std::filesystem::path& file);
  // Parses YAML in memory, with the failures of Load(). `name` is used as the file name in messages
  // and as the base of relative paths.
  static Config Parse(const std::string& text, const std::string& name);

  // The functions below read `key` of this mapping. Without a default value the key is required.
  // All values are returned in SI units; a 0 needs no unit. Each throws InputError with position
  // and field if the key is missing, has the wrong type or unit, or lies outside the bounds.
  double Quantity(const std::string& key, const Dimension& dimension, const Bounds& bounds) const;
  double Quantity(const std::string& key, const Dimension& dimension, const Bounds& bounds,
                  double default_value) const;
  // A quantity of any dimension, which its unit determines.
  MeasuredQuantity AnyQuantity(const std::string& key) const;
  double Number(const std::string& key, const Bounds& bounds) const;
  double Number(const std::string& key, const Bounds& bounds, double default_value) const;
  int Integer(const std::string& key, int min, int max) const;
  int Integer(const std::string& key, int min, int max, int default_value) const;
  bool Flag(const std::string& key, bool default_value) const;
  std::string Text(const std::string& key) const;
  std::string Text(const std::string& key, const std::string& default_value) const;
  // A string that a file or folder is named after (IsFileName in core/file_name.h).
  std::string Name(const std::string& key) const;
  // One string or a list of strings; empty if the key is absent.
  std::vector<std::string> Texts(const std::string& key) const;
  // A list of whole numbers; empty if the key is absent.
  std::vector<int> Integers(const std::string& key, int min) const;
  // Three quantities, as in [0, 0, -9.81 m/s^2].
  Eigen::Vector3d Vector(const std::string& key, const Dimension& dimension) const;
  Eigen::Vector3d Vector(const std::string& key, const Dimension& dimension,
                         const Eigen::Vector3d& default_value) const;
  // A list of quantities of any length; empty if the key is absent.
  std::vector<double> Quantities(const std::string& key, const Dimension& dimension,
                                 const Bounds& bounds) const;
  // A path. A relative path is resolved from the folder of the file that contains it; "${NAME}" is
  // replaced by the value of the environment variable NAME.
  std::filesystem::path Path(const std::string& key) const;
  std::filesystem::path Path(const std::string& key, const std::string& default_value) const;

  // The value in `choices` with the name that is read; the error message lists the known names.
  template <typename T>
  T Choice(const std::string& key, const std::vector<std::pair<std::string, T>>& choices) const {
    return choices[ChoiceIndex(key, Names(choices), std::nullopt)].second;
  }
  template <typename T>
  T Choice(const std::string& key, const std::vector<std::pair<std::string, T>>& choices,
           const std::string& default_name) const {
    return choices[ChoiceIndex(key, Names(choices), default_name)].second;
  }

  // Whether the mapping has a non-null entry of this key. Does not count as a read.
  bool Has(const std::string& key) const;
  // All keys of this mapping, in the order of the file.
  std::vector<std::string> Keys() const;
  // The mapping at `key`, which is required.
  Config Child(const std::string& key) const;
  // The mapping at `key`, if there is one.
  std::optional<Config> OptionalChild(const std::string& key) const;
  // The items of the list of mappings at `key`; empty if the key is absent.
  std::vector<Config> Items(const std::string& key) const;

  // Throws InputError for the first key, in this mapping or below it, that has not been requested
  // by any read. Call it after everything has been read.
  void RefuseUnknownKeys() const;

  // Throws InputError "field: message" at the position of `key`, or of this mapping for an empty
  // key.
  [[noreturn]] void Fail(const std::string& key, const std::string& message) const;
  // Fail() at the position of an item, counted from 0, of the list at `key`.
  [[noreturn]] void FailAtItem(const std::string& key, size_t item,
                               const std::string& message) const;

  // The file given to Load, or the name given to Parse.
  std::filesystem::path File() const;
  // Everything that has been read so far, defaults included, in SI units.
  nlohmann::json Resolved() const;

 private:
  explicit Config(std::shared_ptr<ConfigNode> node);
  template <typename T>
  static std::vector<std::string> Names(const std::vector<std::pair<std::string, T>>& choices) {
    std::vector<std::string> names;
    for (const auto& choice : choices) names.push_back(choice.first);
    return names;
  }
  size_t ChoiceIndex(const std::string& key, const std::vector<std::string>& names,
                     const std::optional<std::string>& default_name) const;

  std::shared_ptr<ConfigNode> node_;
};

}  // namespace lacuna

#endif  // LACUNA_CORE_CONFIG_H_
