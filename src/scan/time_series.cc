#include "scan/time_series.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "core/atomic_file.h"
#include "core/npy.h"
#include "geometry/hermite.h"
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
                           const std::vector<std::string>& names, double unit) {
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
        AsVector(HeaderValuesOf(frames.headers, names[k], unit, config.Text("unit", "N")))
            .transpose();
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

void RefuseOtherUnit(const DelimitedTable& table, Eigen::Index column, double unit,
                     const Dimension& dimension, const std::string& key) {
  if (table.header.empty()) return;
  const std::string& header = table.header[static_cast<size_t>(column)];
  const std::string own = SplitColumnName(header).unit;
  MeasuredQuantity named;
  try {
    named = ParseAnyQuantity("1 " + own);
  } catch (const std::invalid_argument&) {
    return;  // a remark
  }
  constexpr double kRounding = 1e-9;
  if (!named.dimension.SameAs(dimension) || std::abs(named.value - unit) <= kRounding * unit)
    return;
  throw InputError({table.file.string()},
                   fmt::format("has a column \"{}\", but its values are read in another unit; say "
                               "`{}: {}` in recording.yaml, or rename the column",
                               header, key, own));
}

void RefuseOtherUnits(const DelimitedTable& table, const std::vector<std::string>& names,
                      double unit, const Dimension& dimension, const std::string& key) {
  if (table.header.empty()) return;
  for (const std::string& name : names)
    RefuseOtherUnit(table, RequireColumn(table, name), unit, dimension, key);
}

Eigen::MatrixXd ColumnsOf(const DelimitedTable& table, const std::vector<std::string>& names,
                          double unit) {
  Eigen::MatrixXd columns(static_cast<Eigen::Index>(names.size()), table.values.rows());
  for (size_t k = 0; k < names.size(); ++k)
    columns.row(static_cast<Eigen::Index>(k)) =
        unit * table.values.col(RequireColumn(table, names[k])).transpose();
  return columns;
}

TimeSeries ReadTimeSeries(const Config& config, const DataLocation& data, const FrameData& frames,
                          double unit, const Dimension& dimension, const std::string& key) {
  const std::vector<std::string> names = {config.Text("x", "1"), config.Text("y", "2"),
                                          config.Text("z", "3")};
  TimeSeries series = ReadColumns(config, data, frames, names, unit);
  RefuseOtherUnits(series.table, names, unit, dimension, key);
  return series;
}

TimeSeries ReadColumns(const Config& config, const DataLocation& data, const FrameData& frames,
                       const std::vector<std::string>& names, double unit) {
  if (config.Has("from")) return ReadFromHeaders(config, frames, names, unit);
  const std::filesystem::path file = data.folder / config.Text("file");
  if (!std::filesystem::exists(file)) config.Fail("file", "there is no file " + file.string());
  TimeSeries series;
  series.table = ReadTableOrArray(file);
  const DelimitedTable& table = series.table;
  if (table.values.rows() == 0) config.Fail("file", file.string() + " has no rows");
  const std::string time = config.Text("time", "");
  series.values = ColumnsOf(table, names, unit);
  if (!time.empty()) {
    const double time_unit = ReadUnit(config, "time_unit", kTime, "s");
    const Eigen::Index column = RequireColumn(table, time);
    RefuseOtherUnit(table, column, time_unit, kTime, "time_unit");
    series.times = time_unit * table.values.col(column);
  } else if (table.values.rows() == static_cast<Eigen::Index>(frames.times.size())) {
    series.times = AsVector(frames.times);
  } else {
    config.Fail("file", fmt::format("{} has {} rows for {} frames; name its column `time`",
                                    file.string(), table.values.rows(), frames.times.size()));
  }
  for (Eigen::Index i = 0; i < series.times.size(); ++i) {
    const bool ascends = i == 0 || series.times[i] > series.times[i - 1];
    if (!std::isfinite(series.times[i]) || !ascends || !series.values.col(i).allFinite()) {
      config.Fail("file", PlaceOfRow(table, i) +
                              ": is not finite or does not follow the row before in time");
    }
  }
  return series;
}

Eigen::VectorXd InterpolateLinearly(const Eigen::VectorXd& times,
                                    const Eigen::Ref<const Eigen::MatrixXd>& values, double time) {
  const auto [left, right, t] = FindInterval(times, time);
  return (1 - t) * values.col(left) + t * values.col(right);
}

Eigen::Vector3d InterpolateSmoothly(const Eigen::VectorXd& times, const Eigen::Matrix3Xd& values,
                                    double time) {
  const auto [left, right, t] = FindInterval(times, time);
  if (left == right) return values.col(left);
  const Eigen::Index last = times.size() - 1;
  const auto slope = [&](Eigen::Index k) -> Eigen::Vector3d {  // between k and k + 1
    return (values.col(k + 1) - values.col(k)) / (times[k + 1] - times[k]);
  };
  const auto knot = [&](Eigen::Index k) -> Knot<Eigen::Vector3d> {
    if (k == 0) return {values.col(0), slope(0)};
    if (k == last) return {values.col(last), slope(last - 1)};
    const double before = times[k] - times[k - 1], behind = times[k + 1] - times[k];
    return {values.col(k), (behind * slope(k - 1) + before * slope(k)) / (before + behind)};
  };
  return Interpolate(knot(left), knot(right), times[right] - times[left], t).position;
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
