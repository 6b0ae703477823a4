#include "report/run_differences.h"

#include <fmt/format.h>

#include <map>
#include <set>

#include "core/error.h"
#include "core/field_path.h"

namespace lacuna {
namespace {

using nlohmann::json;

std::string ValueText(const json& value) {
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_float()) return fmt::format("{:.6g}", value.get<double>());
  return value.dump(-1, ' ', false, json::error_handler_t::replace);
}

// Every value of a configuration by its path: "effects[1].beta".
void Flatten(const json& value, const std::string& path, std::map<std::string, std::string>* all) {
  if (value.is_object() && !value.empty()) {
    for (const auto& [key, item] : value.items()) Flatten(item, EntryOf(path, key), all);
  } else if (value.is_array() && !value.empty() && value.front().is_structured()) {
    for (size_t k = 0; k < value.size(); ++k)
      Flatten(value[k], fmt::format("{}[{}]", path, k), all);
  } else {
    (*all)[path] = ValueText(value);
  }
}

std::string DescribeSpan(const MeasuredSpan& span) {
  return fmt::format("{} with {} fitted and {} held-out frames of {}", span.recording,
                     span.fitted_frames, span.held_out_frames, span.unit);
}

std::string MismatchOf(const ComparableRun& a, const ComparableRun& b) {
  if (a.spans.size() != b.spans.size())
    return fmt::format("they have {} and {} recordings", a.spans.size(), b.spans.size());
  for (size_t k = 0; k < a.spans.size(); ++k) {
    const std::string first = DescribeSpan(a.spans[k]), second = DescribeSpan(b.spans[k]);
    if (first != second) return fmt::format("{}, and {}", first, second);
  }
  for (const auto& [file, hash] : a.manifest.inputs) {
    const auto other = b.manifest.inputs.find(file);
    if (other == b.manifest.inputs.end()) return fmt::format("only the first has read {}", file);
    if (other->second != hash) return fmt::format("the content of {} is not the same", file);
  }
  if (a.manifest.inputs.size() != b.manifest.inputs.size())
    return "the second has read further files";
  return "";
}

}  // namespace

void RefuseOtherMetrics(const std::vector<ComparableRun>& runs) {
  for (size_t k = 1; k < runs.size(); ++k) {
    const std::string mismatch = MismatchOf(runs.front(), runs[k]);
    if (!mismatch.empty())
      throw InputError(fmt::format("the errors of {} and {} cannot be compared: {}",
                                   runs.front().name, runs[k].name, mismatch));
  }
}

json ConfigurationDifferences(const std::vector<ComparableRun>& runs) {
  std::vector<std::map<std::string, std::string>> flat(runs.size());
  std::set<std::string> keys;
  for (size_t k = 0; k < runs.size(); ++k) {
    Flatten(runs[k].manifest.configuration, "", &flat[k]);
    for (const auto& [key, value] : flat[k]) keys.insert(key);
  }
  json differences = json::array();
  for (const std::string& key : keys) {
    std::vector<std::string> values;
    for (const auto& one : flat) values.push_back(one.contains(key) ? one.at(key) : "");
    if (std::set<std::string>(values.begin(), values.end()).size() > 1)
      differences.push_back({{"key", key}, {"values", values}});
  }
  return differences;
}

}  // namespace lacuna
