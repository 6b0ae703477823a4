#include "scan/marker_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <set>
#include <utility>

#include "core/error.h"
#include "geometry/text_scanner.h"
#include "scan/capture_tables.h"
#include "scan/column_units.h"
#include "scan/delimited_table.h"
#include "scan/table_numbers.h"
#include "scan/table_text.h"
#include "scan/time_series.h"

namespace lacuna {
namespace {

// The marker's name in `column` when it fits the pattern with its one star, with regard to the case
// of letters or without; empty otherwise.
std::string MatchStar(const std::string& column, const std::string& pattern, bool case_counts) {
  const size_t star = pattern.find('*');
  const std::string before = pattern.substr(0, star);
  const std::string after = pattern.substr(star + 1);
  if (column.size() <= before.size() + after.size()) return "";
  const auto is_same = [case_counts](char a, char b) { return IsSameLetter(a, b, case_counts); };
  if (!std::equal(before.begin(), before.end(), column.begin(), is_same)) return "";
  if (!std::equal(after.rbegin(), after.rend(), column.rbegin(), is_same)) return "";
  return column.substr(before.size(), column.size() - before.size() - after.size());
}

// The names of the markers whose columns fit the pattern; in any case where none fits exactly.
std::vector<std::string> NamesIn(const DelimitedTable& table, const std::string& pattern) {
  std::vector<std::string> names;
  for (const bool case_counts : {true, false}) {
    for (const std::string& column : table.header) {
      std::string name = MatchStar(column, pattern, case_counts);
      if (!name.empty()) names.push_back(std::move(name));
    }
    if (!names.empty()) break;
  }
  return names;
}

std::string FillStar(std::string pattern, const std::string& name) {
  return pattern.replace(pattern.find('*'), 1, name);
}

struct TrcHeader {
  Eigen::Index frame_count = 0;
  Eigen::Index marker_count = 0;
  std::string unit;
  double rate = 0;  // Hz; 0 if it is not stated
};

TrcHeader ReadTrcHeader(const std::filesystem::path& file,
                        const std::vector<std::string_view>& lines) {
  if (lines.size() < 6 || lines[0].find("PathFileType") == std::string_view::npos) {
    throw InputError({file.string()}, "is not a TRC file or ends within its header");
  }
  if (lines[1].find('\t') == std::string_view::npos)
    throw InputError(
        {file.string(), 2, 1},
        "has no tabs, which a TRC file has between its entries; a program or an editor "
        "may have replaced them by spaces");
  const std::vector<std::string_view> keys = SplitFields(lines[1], '\t');
  const std::vector<std::string_view> values = SplitFields(lines[2], '\t');
  TrcHeader header;
  const auto whole_number = [&](std::string_view key, std::string_view text) {
    const std::optional<double> value = ParseNumber(text);
    if (!value || !(*value >= 1 && *value < 1e8) || *value != std::floor(*value)) {
      throw InputError({file.string(), 3, 1},
                       fmt::format("{}: got \"{}\"; expected a whole number ≥ 1", key, text));
    }
    return static_cast<Eigen::Index>(*value);
  };
  for (size_t i = 0; i < std::min(keys.size(), values.size()); ++i) {
    if (keys[i] == "NumFrames") header.frame_count = whole_number(keys[i], values[i]);
    if (keys[i] == "NumMarkers") header.marker_count = whole_number(keys[i], values[i]);
    if (keys[i] == "Units") header.unit = values[i];
    if (keys[i] == "DataRate") header.rate = ParseDecimal(values[i]).value_or(0);
  }
  if (header.frame_count == 0 || header.marker_count == 0) {
    throw InputError({file.string(), 2, 1}, "NumFrames or NumMarkers is missing");
  }
  return header;
}

}  // namespace

MarkerTracks ReadMarkerTracks(const std::filesystem::path& file, const MarkerColumns& columns,
                              FileTimes use) {
  const std::string extension = LowerExtension(file);
  if (extension == ".c3d") return ReadC3d(file, use);
  if (extension == ".trc") return ReadTrc(file, use);
  switch (CaptureTableOf(file)) {
    case CaptureTable::kQualisys:
      return ReadQualisysTsv(file, use);
    case CaptureTable::kMotive:
      return ReadMotiveCsv(file, use);
    case CaptureTable::kDeepLabCut:
      return ReadDeepLabCutCsv(file);
    case CaptureTable::kNone:
      break;
  }
  return ReadMarkerCsv(file, columns, use);
}

MarkerTracks ReadMarkerCsv(const std::filesystem::path& file, const MarkerColumns& columns,
                           FileTimes use) {
  const DelimitedTable table = ReadDelimitedTable(file);
  MarkerTracks tracks;
  tracks.warnings = table.notes;
  if (table.header.empty()) {
    throw InputError(
        {file.string(), table.line.front(), 1},
        fmt::format("has no line with the names of the columns, such as {} for a marker "
                    "\"tip\", above its numbers",
                    FillStar(columns.x, "tip")));
  }
  tracks.names = NamesIn(table, columns.x);
  if (tracks.names.empty()) {
    throw InputError({file.string(), 1, 1},
                     fmt::format("no column matches \"{}\"; its columns are {}", columns.x,
                                 fmt::join(table.header, ", ")));
  }
  std::set<std::string> seen;
  for (const std::string& name : tracks.names) {
    if (!seen.insert(name).second)
      throw InputError({file.string(), 1, 1},
                       fmt::format("has several columns \"{}\"; rename the marker of one of them",
                                   FillStar(columns.x, name)));
  }
  const Eigen::Index frame_count = table.values.rows();
  tracks.positions.assign(frame_count, Eigen::Matrix3Xd(3, tracks.names.size()));
  for (size_t marker = 0; marker < tracks.names.size(); ++marker) {
    int axis = 0;
    for (const std::string& pattern : {columns.x, columns.y, columns.z}) {
      const Eigen::Index column = RequireColumn(table, FillStar(pattern, tracks.names[marker]));
      const std::string unit = LengthUnitOfColumn(table, column);
      if (tracks.length_unit.empty()) tracks.length_unit = unit;
      if (unit != tracks.length_unit && !unit.empty())
        throw InputError(
            {file.string(), 1, 1},
            fmt::format("gives coordinates in {} beside others in {}", unit, tracks.length_unit));
      for (Eigen::Index frame = 0; frame < frame_count; ++frame) {
        tracks.positions[frame](axis, marker) = table.values(frame, column);
      }
      ++axis;
    }
  }
  if (!columns.time.empty()) {
    const Eigen::Index time = RequireColumn(table, columns.time);
    if (use == FileTimes::kUsed)
      RefuseOtherUnit(table, time, columns.time_unit, kTime, "time_unit");
    SetTimes(file, columns.time_unit * table.values.col(time), 0, use, &tracks);
  }
  return tracks;
}

MarkerTracks ReadTrc(const std::filesystem::path& file, FileTimes use) {
  const std::string content = ReadFilledText(file);
  const std::vector<std::string_view> lines = SplitLines(content);
  const TrcHeader header = ReadTrcHeader(file, lines);
  MarkerTracks tracks;
  tracks.length_unit = header.unit;
  const std::vector<std::string_view> names = SplitFields(lines[3], '\t');
  for (size_t i = 2; i < names.size(); ++i) {
    if (!names[i].empty()) tracks.names.emplace_back(names[i]);
  }
  if (static_cast<Eigen::Index>(tracks.names.size()) != header.marker_count) {
    throw InputError({file.string(), 4, 1}, fmt::format("names {} markers where NumMarkers says {}",
                                                        tracks.names.size(), header.marker_count));
  }
  NumberRepeatedNames(file, &tracks);
  constexpr double kUnseen = std::numeric_limits<double>::quiet_NaN();
  std::vector<double> times;
  DecimalCommas commas;
  for (size_t row = 5; row < lines.size(); ++row) {
    const std::vector<std::string_view> fields = SplitFields(lines[row], '\t');
    if (AreEmpty(fields)) continue;
    const int line_number = static_cast<int>(row) + 1;
    const size_t expected = 2 + 3 * tracks.names.size();
    const bool has_too_many = std::any_of(fields.begin() + std::min(expected, fields.size()),
                                          fields.end(), [](auto f) { return !f.empty(); });
    // Some programs omit the empty entries behind the last marker that was seen.
    if (fields.size() < 2 || has_too_many) {
      throw InputError({file.string(), line_number, 1},
                       fmt::format("has {} entries; expected {}", fields.size(), expected));
    }
    Eigen::Matrix3Xd positions = Eigen::Matrix3Xd::Constant(3, tracks.names.size(), kUnseen);
    for (size_t i = 1; i < std::min(expected, fields.size()); ++i) {
      const int column = static_cast<int>(fields[i].data() - lines[row].data()) + 1;
      const std::optional<double> value = ParseDecimal(fields[i]);
      if (!value)
        throw InputError({file.string(), line_number, column},
                         fmt::format("got \"{}\"; expected a number", fields[i]));
      commas.Add(fields[i], line_number, column);
      if (i == 1) times.push_back(*value);
      if (i >= 2) positions((i - 2) % 3, (i - 2) / 3) = *value;
    }
    tracks.positions.push_back(std::move(positions));
  }
  commas.RefuseThousands(file, '\t');
  if (static_cast<Eigen::Index>(times.size()) != header.frame_count) {
    throw InputError({file.string()}, fmt::format("holds {} frames where NumFrames says {}",
                                                  times.size(), header.frame_count));
  }
  SetTimes(file, Eigen::Map<const Eigen::VectorXd>(times.data(), times.size()), header.rate, use,
           &tracks);
  return tracks;
}

}  // namespace lacuna
