#include "scan/measured_reaction.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <utility>

#include "scan/time_series.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

constexpr const char* kAxes[] = {"x", "y", "z"};

// The components that are measured, and their columns in the file.
std::vector<std::string> ReadComponents(const Config& item, MeasuredReaction* reaction) {
  std::vector<std::string> columns;
  for (int axis = 0; axis < 3; ++axis) {
    if (!item.Has(kAxes[axis])) continue;
    columns.push_back(item.Text(kAxes[axis]));
    reaction->labels.emplace_back(kAxes[axis]);
    reaction->directions.conservativeResize(3, reaction->directions.cols() + 1);
    reaction->directions.rightCols<1>() = Eigen::Vector3d::Unit(axis);
  }
  if (!item.Has("along")) {
    if (columns.empty())
      item.Fail("file",
                "says nothing about its direction: name the columns of the components `x`, `y`, "
                "`z`, or give `along: [1, 0, 0]` and the column `value`");
    return columns;
  }
  if (!columns.empty())
    item.Fail("along", "the components x, y, z have columns already: give these or `along`");
  const Eigen::Vector3d along = item.Vector("along", kDimensionless);
  if (!(along.norm() > 0)) item.Fail("along", "expected a direction other than 0");
  reaction->labels = {"along"};
  reaction->directions = along.normalized();
  return {item.Text("value")};
}

MeasuredReaction ReadReaction(const Config& item, const DataLocation& data,
                              const std::vector<double>& frame_times) {
  MeasuredReaction reaction;
  const std::vector<std::string> columns = ReadComponents(item, &reaction);
  const double sign = item.Choice<double>("exerted_by", {{"grip", 1.0}, {"object", -1.0}}, "grip");
  const double unit = ReadUnit(item, "unit", kForce, "N");
  TimeSeries series = ReadColumns(item, data, frame_times, columns, sign * unit);
  reaction.times = std::move(series.times);
  reaction.forces = std::move(series.values);
  reaction.file = series.table.file;
  reaction.deviation = item.Quantity("deviation", kForce, kPositive, 0);
  reaction.tare_deviation = item.Quantity("tare_deviation", kForce, kNotNegative, 0);
  return reaction;
}

}  // namespace

bool MeasuredReaction::Covers(double time) const {
  // A frame at the same time as the first or last value may differ from it by rounding.
  constexpr double kRounding = 1e-9;
  const double first = times[0], last = times[times.size() - 1];
  const double margin = kRounding * (last - first);
  return time >= first - margin && time <= last + margin;
}

Eigen::VectorXd ReadingAt(const MeasuredReaction& reaction, double time) {
  CHECK(reaction.Covers(time));
  return InterpolateLinearly(reaction.times, reaction.forces, time);
}

std::vector<MeasuredReaction> ReadReactions(const Config& config, const DataLocation& data,
                                            const std::vector<double>& frame_times,
                                            const std::vector<std::string>& held) {
  std::vector<MeasuredReaction> reactions;
  size_t part = 0;
  for (const char* key : {"fixed", "gripped"}) {
    for (const Config& item : config.Items(key)) {
      CHECK_LT(part, held.size());
      if (const auto child = item.OptionalChild("measured_force")) {
        reactions.push_back(ReadReaction(*child, data, frame_times));
        reactions.back().held = part;
        reactions.back().name = held[part];
      }
      ++part;
    }
  }
  return reactions;
}

std::string DescribeReaction(const MeasuredReaction& reaction) {
  return fmt::format("{}: {} values of {}, at most {:.4g} N", reaction.name, reaction.times.size(),
                     fmt::join(reaction.labels, ", "), reaction.forces.cwiseAbs().maxCoeff());
}

std::string WriteReaction(const std::filesystem::path& folder, const MeasuredReaction& reaction,
                          size_t number) {
  const std::string file = fmt::format("reaction{}.csv", number);
  const bool is_along = reaction.labels.front() == "along";
  std::vector<std::string> columns = reaction.labels;
  if (is_along) columns = {"force"};
  WriteTimeSeries(folder / file, reaction.times, reaction.forces, columns);
  std::string text = fmt::format("measured_force: {{file: {}, time: time, unit: N", file);
  if (is_along)
    text += fmt::format(", along: {}, value: force", FormatVector(reaction.directions.col(0), ""));
  else
    for (const std::string& label : columns) text += fmt::format(", {0}: {0}", label);
  if (reaction.deviation > 0) text += fmt::format(", deviation: {} N", reaction.deviation);
  if (reaction.tare_deviation > 0)
    text += fmt::format(", tare_deviation: {} N", reaction.tare_deviation);
  return text + "}";
}

}  // namespace lacuna
