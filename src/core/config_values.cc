// The reads of Config that return values: quantities, numbers, strings, lists, paths and choices.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "core/config.h"
#include "core/config_node.h"
#include "core/file_name.h"
#include "core/suggestion.h"

namespace lacuna {
namespace {

constexpr int kMaxListLength = 10'000'000;

}  // namespace

double Config::Quantity(const std::string& key, const Dimension& dimension,
                        const Bounds& bounds) const {
  const std::string expected = fmt::format("{}{}, e.g. \"{}\"", dimension.name,
                                           Describe(bounds, dimension.unit), dimension.example);
  const YAML::Node entry = node_->Required(key, expected);
  const std::string text = node_->Scalar(entry, node_->Field(key), expected);
  try {
    const double value = ParseQuantityWithin(text, dimension, bounds);
    node_->values[key] = value;
    return value;
  } catch (const std::invalid_argument& problem) {
    node_->Fail(entry.Mark(), node_->Field(key),
                problem.what() + node_->DecimalCommaHint(key, &dimension));
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

int Config::Integer(const std::string& key, int min, int max) const {
  const YAML::Node entry = node_->Required(key, "a whole number");
  const std::string text = node_->Scalar(entry, node_->Field(key), "a whole number");
  try {
    const int value = ParseInteger(text, min, max);
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
  const YAML::Node entry = node_->Required(key, "a string");
  const std::string text = node_->Scalar(entry, node_->Field(key), "a string");
  node_->values[key] = text;
  return text;
}

std::string Config::Text(const std::string& key, const std::string& default_value) const {
  if (Has(key)) return Text(key);
  node_->values[key] = default_value;
  return default_value;
}

std::string Config::Name(const std::string& key) const {
  const std::string name = Text(key);
  if (!IsFileName(name))
    Fail(key,
         "names a folder of results, so it must not be empty, begin with a dot or contain a slash, "
         "a backslash or a control character");
  return name;
}

std::vector<std::string> Config::Texts(const std::string& key) const {
  std::vector<std::string> texts;
  if (const YAML::Node entry = node_->Find(key)) {
    if (entry.IsScalar()) {
      texts.push_back(entry.Scalar());
    } else if (entry.IsSequence()) {
      for (const auto& item : entry)
        texts.push_back(node_->Scalar(item, fmt::format("{}[{}]", node_->Field(key), texts.size()),
                                      "a string"));
    } else {
      node_->Fail(entry.Mark(), node_->Field(key),
                  "got a mapping; expected a string or a list of strings");
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
        values.push_back(ParseInteger(node_->Scalar(item, field, "a whole number"), min,
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
    if (entry.size() > kMaxListLength)
      node_->Fail(entry.Mark(), node_->Field(key), "the list has too many entries");
    for (const auto& item : entry) {
      const std::string field = fmt::format("{}[{}]", node_->Field(key), values.size());
      const std::string text = node_->Scalar(item, field, dimension.name);
      try {
        values.push_back(ParseQuantityWithin(text, dimension, bounds));
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
  // Before the entries are read: where decimal commas have split them, their units are missing.
  if (entry.IsSequence() && entry.size() != 3) {
    node_->Fail(entry.Mark(), node_->Field(key),
                fmt::format("got {} entries; expected three, e.g. [0, 0, {}]{}", entry.size(),
                            dimension.example,
                            entry.size() > 3 ? "; a comma separates entries, and a decimal "
                                               "separator must be a point"
                                             : ""));
  }
  const std::vector<double> values = Quantities(key, dimension, kAnyValue);
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

}  // namespace lacuna
