#include "scan/time_series.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "core/atomic_file.h"
#include "core/npy.h"
#include "core/quantity.h"
#include "scan/column_units.h"
#include "scan/component_columns.h"
#include "scan/table_header.h"

namespace lacuna {
namespace {

DelimitedTable ReadTableOrArray(const std::filesystem::path& file) {
  if (file.extension() != ".npy") return ReadDelimitedTable(file);
  DelimitedTable table;
  table.file = file;
  table.values = ReadNpyMatrix(file);
  return table;
}

// A time lies at the fraction t of the interval between two neighbouring times of a series. Both
// are the same before the first time and after the last.
struct Interval {
  Eigen::Index left, right;
  double t;
};

Interval FindInterval(const Eigen::VectorXd& times, double time) {
  const Eigen::Index last = times.size() - 1;
  const double* after = std::upper_bound(times.data(), times.data() + times.size(), time);
  const Eigen::Index right = after - times.data();
  if (right == 0) return {0, 0, 0};
  if (right > last) return {last, last, 0};
  return {right - 1, right, (time - times[right - 1]) / (times[right] - times[right - 1])};
}

Eigen::Map<const Eigen::VectorXd> AsVector(const std::vector<double>& values) {
  return {values.data(), static_cast<Eigen::Index>(values.size())};
}

// The values `names` in the headers of the frame files.
TimeSeries ReadFromHeaders(const Config& config, const FrameData& frames,
                           const std::vector<std::string>& names, const ColumnUnit& unit) {
  config.Choice<int>("from", {{"headers", 0}});
  if (config.Has("file")) config.Fail("file", "the values come `from: headers` already");
  if (frames.headers.empty())
    config.Fail("from", "the files of these frames have no headers with values");
  TimeSeries series;
  series.table.file = frames.headers.front();
  series.times = AsVector(frames.times);
  series.values.resize(static_cast<Eigen::Index>(names.size()), series.times.size());
  for (size_t k = 0; k < names.size(); ++k)
    series.values.row(static_cast<Eigen::Index>(k)) =
        AsVector(HeaderValuesOf(frames.headers, names[k], unit.si, unit.symbol)).transpose();
  return series;
}

DelimitedTable TableOf(const Config& config, const DataLocation& data) {
  const std::filesystem::path file = data.folder / config.Text("file");
  if (!std::filesystem::exists(file)) config.Fail("file", "there is no file " + file.string());
  DelimitedTable table = ReadTableOrArray(file);
  if (table.values.rows() == 0) config.Fail("file", file.string() + " has no rows");
  return table;
}

Eigen::VectorXd TimesOf(const Config& config, const DelimitedTable& table, const FrameData& frames,
                        const std::vector<std::string>& names) {
  const std::string time = config.Text("time", "");
  if (time.empty()) {
    if (table.values.rows() != static_cast<Eigen::Index>(frames.times.size()))
      config.Fail("file",
                  fmt::format("{} has {} rows for {} frames; say with `time` which column "
                              "holds the times",
                              table.file.string(), table.values.rows(), frames.times.size()));
    return AsVector(frames.times);
  }
  const double unit = ReadUnit(config, "time_unit", kTime, "s");
  const Eigen::Index column = RequireColumn(table, time);
  RefuseOtherUnit(table, column, unit, kTime, "time_unit");
  for (const std::string& name : names)
    if (RequireColumn(table, name) == column)
      config.Fail("time", fmt::format("is column {} of {}, from which values are also read; "
                                      "name the columns of the values",
                                      column + 1, table.file.string()));
  return unit * table.values.col(column);
}

// Leaves out the rows without a value and averages those of equal times.
void KeepMeasured(TimeSeries* series) {
  Eigen::Index kept = 0, missing = 0, equal = 0;
  double count = 0;  // of the rows that the last one kept is the mean of
  for (Eigen::Index i = 0; i < series->times.size(); ++i) {
    const Eigen::VectorXd value = series->values.col(i);
    if (!value.allFinite()) {
      ++missing;
    } else if (kept > 0 && series->times[i] == series->times[kept - 1]) {
      ++equal;
      ++count;
      series->values.col(kept - 1) += (value - series->values.col(kept - 1)) / count;
    } else {
      series->times[kept] = series->times[i];
      series->values.col(kept++) = value;
      count = 1;
    }
  }
  std::vector<std::string> gaps;
  if (missing > 0) gaps.push_back(fmt::format("rows without a value, left out: {}", missing));
  if (equal > 0) gaps.push_back(fmt::format("rows with the time of another, averaged: {}", equal));
  series->gaps = fmt::format("{}", fmt::join(gaps, ", "));
  series->times.conservativeResize(kept);
  series->values.conservativeResize(Eigen::NoChange, kept);
}

void CheckRows(const Config& config, const TimeSeries& series, Rows rows) {
  const Eigen::VectorXd& times = series.times;
  for (Eigen::Index i = 0; i < times.size(); ++i) {
    const auto fail = [&](const std::string& problem) {
      config.Fail("file", PlaceOfRow(series.table, i) + ": " + problem);
    };
    if (!std::isfinite(times[i])) fail("has no time");
    if (i > 0 && times[i] < times[i - 1])
      fail(fmt::format("its time, {}, is before that of the row above; sort the rows",
                       TimeText(times[i])));
    if (rows == Rows::kMeasured) continue;
    if (!series.values.col(i).allFinite()) fail("has an entry that is missing or not finite");
    if (i > 0 && times[i] == times[i - 1])
      fail(
          fmt::format("has the time of the row above, {}, perhaps because it was rounded; leave "
                      "one of the two out",
                      TimeText(times[i])));
  }
}

// The usual name of the column of one component, or its number in a table without names.
std::string ComponentIn(const Config& config, const DelimitedTable& table, int axis,
                        const Dimension& dimension) {
  const std::string key(1, "xyz"[axis]);
  std::string name = std::to_string(axis + 1);
  if (!table.header.empty()) {
    name = dimension.SameAs(kForce) && FindColumn(table, "f" + key) ? "f" + key : key;
    if (!FindColumn(table, name))
      config.Fail("file", fmt::format("{} has no column \"{}\"; say with `x`, `y` and `z` which of "
                                      "its columns are meant: {}",
                                      table.file.string(), name, fmt::join(table.header, ", ")));
  }
  return config.Text(key, name);
}

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

TimeSeries SeriesOf(const Config& config, DelimitedTable table, const FrameData& frames,
                    const std::vector<std::string>& names, const ColumnUnit& unit, Rows rows) {
  TimeSeries series;
  series.times = TimesOf(config, table, frames, names);
  series.values = ColumnsOf(table, names, unit.si);
  RefuseOtherUnits(table, names, unit.si, unit.dimension, unit.key);
  series.table = std::move(table);
  CheckRows(config, series, rows);
  if (rows == Rows::kMeasured) KeepMeasured(&series);
  if (series.times.size() == 0)
    config.Fail("file", series.table.file.string() + " has no row with a value");
  return series;
}

}  // namespace

std::string PlaceOfRow(const DelimitedTable& table, Eigen::Index row) {
  const auto k = static_cast<size_t>(row);
  return k < table.line.size() ? fmt::format("{}:{}", table.file.string(), table.line[k])
                               : fmt::format("{}: row {}", table.file.string(), k + 1);
}

double ReadUnit(const Config& config, const std::string& key, const Dimension& dimension,
                const std::string& default_unit) {
  const std::string unit = config.Text(key, default_unit);
  try {
    return ParseQuantity("1 " + unit, dimension);
  } catch (const std::invalid_argument& problem) {
    config.Fail(key, problem.what());
  }
}

ColumnUnit ReadColumnUnit(const Config& config, const std::string& key, const Dimension& dimension,
                          const std::string& default_unit) {
  return {ReadUnit(config, key, dimension, default_unit), dimension, key,
          config.Text(key, default_unit)};
}

Eigen::MatrixXd ColumnsOf(const DelimitedTable& table, const std::vector<std::string>& names,
                          double unit) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(names.size()), table.values.rows());
  for (size_t k = 0; k < names.size(); ++k)
    columns.row(static_cast<Eigen::Index>(k)) =
        unit * table.values.col(RequireColumn(table, names[k])).transpose();
  return columns;
}

TimeSeries ReadVectorSeries(const Config& config, const DataLocation& data, const FrameData& frames,
                            const ColumnUnit& unit, Rows rows) {
  if (NamesComponents(config)) {
    const ComponentColumns components = ReadComponentColumns(config);
    TimeSeries series = ReadColumns(config, data, frames, components.columns, unit, rows);
    if (!config.Has("along")) RefuseUnnamedComponents(config, series.table);
    series.values = Eigen::MatrixXd(components.directions * series.values);
    return series;
  }
  if (config.Has("from"))
    return ReadFromHeaders(config, frames, {config.Text("x"), config.Text("y"), config.Text("z")},
                           unit);
  DelimitedTable table = TableOf(config, data);
  std::vector<std::string> names;
  for (int axis = 0; axis < 3; ++axis)
    names.push_back(ComponentIn(config, table, axis, unit.dimension));
  return SeriesOf(config, std::move(table), frames, names, unit, rows);
}

TimeSeries ReadColumns(const Config& config, const DataLocation& data, const FrameData& frames,
                       const std::vector<std::string>& names, const ColumnUnit& unit, Rows rows) {
  if (config.Has("from")) return ReadFromHeaders(config, frames, names, unit);
  return SeriesOf(config, TableOf(config, data), frames, names, unit, rows);
}

Eigen::VectorXd InterpolateLinearly(const Eigen::VectorXd& times,
                                    const Eigen::Ref<const Eigen::MatrixXd>& values, double time) {
  const auto [left, right, t] = FindInterval(times, time);
  return (1 - t) * values.col(left) + t * values.col(right);
}

void WriteTimeSeries(const std::filesystem::path& file, const Eigen::VectorXd& times,
                     const Eigen::Ref<const Eigen::MatrixXd>& values,
                     const std::vector<std::string>& names) {
  std::string csv = fmt::format("time,{}\n", fmt::join(names, ","));
  for (Eigen::Index k = 0; k < times.size(); ++k) {
    csv += fmt::format("{}", times[k]);
    for (const double value : values.col(k)) csv += fmt::format(",{}", value);
    csv += "\n";
  }
  WriteFileAtomically(file, csv);
}

}  // namespace lacuna
