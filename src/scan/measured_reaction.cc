#include "scan/measured_reaction.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <utility>

#include "scan/component_columns.h"
#include "scan/time_series.h"
#include "scan/time_span.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

MeasuredReaction ReadReaction(const Config& item, const DataLocation& data, const FrameData& frames,
                              bool is_torque) {
  MeasuredReaction reaction;
  reaction.is_torque = is_torque;
  const Dimension& dimension = is_torque ? kTorque : kForce;
  ComponentColumns components = ReadComponentColumns(item);
  const double sign = item.Choice<double>(
      "exerted_by", {{"grip", 1.0}, {"object", -1.0}, {"unknown", 0.0}}, "grip");
  reaction.sign_is_unknown = sign == 0;
  const ColumnUnit unit = ReadColumnUnit(item, "unit", dimension, reaction.Unit());
  TimeSeries series = ReadColumns(item, data, frames, components.columns, unit, Rows::kMeasured);
  reaction.labels = std::move(components.labels);
  reaction.directions = std::move(components.directions);
  reaction.times = std::move(series.times);
  reaction.values = std::move(series.values);
  if (sign < 0) reaction.values *= -1;
  reaction.gaps = std::move(series.gaps);
  reaction.file = series.table.file;
  reaction.time_margin = TimeMargin(frames.times);
  reaction.deviation = item.Quantity("deviation", dimension, kPositive, 0);
  reaction.tare_deviation = item.Quantity("tare_deviation", dimension, kNotNegative, 0);
  reaction.delay_deviation = item.Quantity("delay_deviation", kTime, kNotNegative, 0);
  if (is_torque && item.Has("about")) reaction.about = item.Vector("about", kLength);
  return reaction;
}

}  // namespace

bool MeasuredReaction::Covers(double time) const {
  return CoversTimes(times, time, time, time_margin);
}

Eigen::VectorXd ReadingAt(const MeasuredReaction& reaction, double time) {
  CHECK(reaction.Covers(time));
  return InterpolateLinearly(reaction.times, reaction.values, time);
}

std::vector<MeasuredReaction> ReadReactions(const Config& config, const DataLocation& data,
                                            const FrameData& frames,
                                            const std::vector<std::string>& held,
                                            const std::vector<AxisSet>& axes) {
  CHECK_EQ(held.size(), axes.size());
  std::vector<MeasuredReaction> reactions;
  size_t part = 0;
  for (const char* key : {"fixed", "gripped"}) {
    for (const Config& item : config.Items(key)) {
      CHECK_LT(part, held.size());
      for (const bool is_torque : {false, true}) {
        const auto child = item.OptionalChild(is_torque ? "measured_torque" : "measured_force");
        if (!child) continue;
        reactions.push_back(ReadReaction(*child, data, frames, is_torque));
        for (int axis = 0; axis < 3 && !is_torque; ++axis)
          if (!axes[part].Has(axis) && !reactions.back().directions.row(axis).isZero(0))
            child->Fail("", fmt::format("has a component along {}, along which {} is not held and "
                                        "exerts no force",
                                        "xyz"[axis], held[part]));
        reactions.back().held = part;
        reactions.back().name = held[part];
      }
      ++part;
    }
  }
  return reactions;
}

std::string DescribeReaction(const MeasuredReaction& reaction) {
  return fmt::format("{}: {} values of {}{}, at most {:.4g} {}{}", reaction.name,
                     reaction.times.size(), reaction.is_torque ? "the torque " : "",
                     fmt::join(reaction.labels, ", "), reaction.values.cwiseAbs().maxCoeff(),
                     reaction.Unit(), reaction.gaps.empty() ? "" : "; " + reaction.gaps);
}

std::string WriteReaction(const std::filesystem::path& folder, const MeasuredReaction& reaction,
                          size_t number) {
  const std::string file = fmt::format("reaction{}.csv", number);
  const bool is_along = reaction.labels.front() == "along";
  std::vector<std::string> columns = reaction.labels;
  if (is_along) columns = {reaction.Quantity()};
  WriteTimeSeries(folder / file, reaction.times, reaction.values, columns);
  std::string text = fmt::format("measured_{}: {{file: {}, time: time, unit: {}",
                                 reaction.Quantity(), file, reaction.Unit());
  if (is_along)
    text += fmt::format(", along: {}, value: {}", FormatVector(reaction.directions.col(0), ""),
                        columns[0]);
  else
    for (const std::string& label : columns) text += fmt::format(", {0}: {0}", label);
  if (reaction.about) text += ", about: " + FormatVector(*reaction.about, "m");
  if (reaction.deviation > 0)
    text += fmt::format(", deviation: {} {}", reaction.deviation, reaction.Unit());
  if (reaction.tare_deviation > 0)
    text += fmt::format(", tare_deviation: {} {}", reaction.tare_deviation, reaction.Unit());
  if (reaction.delay_deviation > 0)
    text += fmt::format(", delay_deviation: {} s", reaction.delay_deviation);
  if (reaction.sign_is_unknown) text += ", exerted_by: unknown";
  return text + "}";
}

}  // namespace lacuna
