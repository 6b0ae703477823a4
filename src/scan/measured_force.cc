#include "scan/measured_force.h"

#include <fmt/format.h>

#include "core/quoted_text.h"
#include "scan/component_columns.h"
#include "scan/delimited_table.h"
#include "scan/time_series.h"
#include "scan/yaml_format.h"

namespace lacuna {

namespace {

// A component that is not named counts as 0. Where the table has a column with its usual name, that
// may not have been meant, and where no column has a name, that cannot be told.
void RefuseUnnamedComponents(const Config& item, const DelimitedTable& table) {
  if (table.header.empty() && !(item.Has("x") && item.Has("y") && item.Has("z")))
    item.Fail(item.Has("file") ? "file" : "from",
              "columns without names do not tell whether the other components are among them: give "
              "`x`, `y` and `z`, or a component in one direction with `along` and `value`");
  for (const std::string axis : {"x", "y", "z"}) {
    if (item.Has(axis)) continue;
    for (const std::string& usual : {"f" + axis, axis})
      if (FindColumn(table, usual))
        item.Fail("file", fmt::format("{} has a column \"{}\", but `{}` is not given: name it with "
                                      "`{}`, or give a component in one direction with `along` and "
                                      "`value`",
                                      table.file.string(), usual, axis, axis));
  }
}

// 3 × k, N: the components that the item names, or all three in columns with their usual names.
TimeSeries ReadForceSeries(const Config& item, const DataLocation& data, const FrameData& frames) {
  const ColumnUnit unit = ReadColumnUnit(item, "unit", kForce, "N");
  if (!NamesComponents(item)) return ReadTimeSeries(item, data, frames, unit, Rows::kMeasured);
  const ComponentColumns components = ReadComponentColumns(item);
  TimeSeries series = ReadColumns(item, data, frames, components.columns, unit, Rows::kMeasured);
  if (!item.Has("along")) RefuseUnnamedComponents(item, series.table);
  series.values = Eigen::MatrixXd(components.directions * series.values);
  return series;
}

}  // namespace

Eigen::Vector3d ForceAt(const MeasuredForce& force, double time) {
  return InterpolateLinearly(force.times, force.forces, time);
}

std::vector<MeasuredForce> ReadForces(const Config& config, const DataLocation& data,
                                      const FrameData& frames, double first_time) {
  std::vector<MeasuredForce> forces;
  for (const Config& item : config.Items("forces")) {
    MeasuredForce force;
    force.name = item.Text("name", fmt::format("force {}", forces.size() + 1));
    if (const auto region = item.OptionalChild("region")) {
      force.region = ReadRegion(*region, data.folder, force.name);
    }
    if (item.Has("constant")) {
      if (item.Has("file")) item.Fail("file", "the force is already given as a constant");
      force.forces = item.Vector("constant", kForce);
      force.times = Eigen::VectorXd::Constant(1, first_time);
    } else {
      const TimeSeries series = ReadForceSeries(item, data, frames);
      force.file = series.table.file;
      force.times = series.times;
      force.forces = series.values;
      force.gaps = series.gaps;
    }
    forces.push_back(std::move(force));
  }
  return forces;
}

std::string DescribeForce(const MeasuredForce& force) {
  return fmt::format("{}: {} values, at most {:.4g} N{}{}", force.name, force.times.size(),
                     force.forces.colwise().norm().maxCoeff(),
                     force.region ? ", on " + DescribeRegion(*force.region) : "",
                     force.gaps.empty() ? "" : "; " + force.gaps);
}

std::string WriteForce(const std::filesystem::path& folder, const MeasuredForce& force,
                       size_t number) {
  std::string item = fmt::format("{{name: {}", QuotedText(force.name));
  if (force.times.size() == 1) {  // a table of one row would not cover the frames
    item += ", constant: " + FormatVector(force.forces.col(0), "N");
  } else {
    const std::string file = fmt::format("force{}.csv", number);
    WriteTimeSeries(folder / file, force.times, force.forces);
    item += fmt::format(", file: {}, time: time, x: x, y: y, z: z, unit: N", file);
  }
  if (force.region) item += ", region: " + FormatRegion(*force.region);
  return item + "}";
}

}  // namespace lacuna
