#include "scan/capture_tables.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "scan/table_numbers.h"
#include "scan/table_text.h"

namespace lacuna {
namespace {

constexpr double kNotSeen = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void FailAt(const std::filesystem::path& file, size_t row,
                         const std::string& message) {
  throw InputError({file.string(), static_cast<int>(row) + 1, 1}, message);
}

// The number in a field; NaN where it is empty or says that there is none.
double NumberIn(const std::filesystem::path& file, std::string_view line, size_t row,
                std::string_view field) {
  if (IsMissing(field)) return kNotSeen;
  const std::optional<double> value = ParseNumber(field);
  if (!value)
    throw InputError({file.string(), static_cast<int>(row) + 1,
                      static_cast<int>(field.data() - line.data()) + 1},
                     fmt::format("got \"{}\"; expected a number", field));
  return *value;
}

// The columns of one marker.
struct MarkerColumnTriple {
  std::string name;
  size_t first = 0;  // of x, y, z
};

// Whether a line of a Qualisys file begins with the name of a variable, such as MARKER_NAMES.
bool IsVariable(std::string_view field) {
  return !field.empty() && field != "NULL" && std::all_of(field.begin(), field.end(), [](char c) {
    return c == '_' || (c >= 'A' && c <= 'Z');
  });
}

// How many columns stand in front of the coordinates in a row of Qualisys, at most 2. The entries
// of a last marker that was not seen are empty, three each; what is empty beyond are tabs at the
// end of the row.
size_t ColumnsBefore(const std::vector<std::string_view>& fields, size_t coordinates) {
  const auto last = std::find_if(fields.rbegin(), fields.rend(),
                                 [](std::string_view field) { return !field.empty(); });
  const size_t width = fields.size() - static_cast<size_t>(last - fields.rbegin()) % 3;
  return std::min<size_t>(2, width - std::min(width, coordinates));
}

// Appends the positions in a row.
void AddRow(const std::filesystem::path& file, std::string_view line, size_t row,
            const std::vector<std::string_view>& fields,
            const std::vector<MarkerColumnTriple>& markers, bool zero_is_unseen,
            MarkerTracks* tracks) {
  Eigen::Matrix3Xd positions(3, static_cast<Eigen::Index>(markers.size()));
  for (size_t m = 0; m < markers.size(); ++m) {
    auto position = positions.col(static_cast<Eigen::Index>(m));
    for (size_t axis = 0; axis < 3; ++axis) {
      const size_t at = markers[m].first + axis;
      position[static_cast<Eigen::Index>(axis)] =
          at < fields.size() ? NumberIn(file, line, row, fields[at]) : kNotSeen;
    }
    if (zero_is_unseen && position.isZero(0)) position.setConstant(kNotSeen);
  }
  tracks->positions.push_back(std::move(positions));
}

// Times of the rows; empty: the file has none.
Eigen::Map<const Eigen::VectorXd> AsTimes(const std::vector<double>& times) {
  return {times.data(), static_cast<Eigen::Index>(times.size())};
}

// "key,value,key,value,…", the first line of Motive.
std::map<std::string, std::string> PairsIn(std::string_view line) {
  const std::vector<std::string_view> fields = SplitFields(line, ',');
  std::map<std::string, std::string> pairs;
  for (size_t i = 0; i + 1 < fields.size(); i += 2)
    pairs.emplace(std::string(fields[i]), std::string(fields[i + 1]));
  return pairs;
}

std::string UnitOfMotive(const std::map<std::string, std::string>& pairs) {
  const auto found = pairs.find("Length Units");
  if (found == pairs.end()) return "";
  if (found->second == "Meters") return "m";
  if (found->second == "Centimeters") return "cm";
  if (found->second == "Millimeters") return "mm";
  return found->second;
}

// The markers that the rows above the data name: `types`, `names`, `quantities` and `axes` have an
// entry for each column.
std::vector<MarkerColumnTriple> MarkersOfMotive(const std::vector<std::string_view>& types,
                                                const std::vector<std::string_view>& names,
                                                const std::vector<std::string_view>& quantities,
                                                const std::vector<std::string_view>& axes) {
  std::vector<MarkerColumnTriple> markers;
  const size_t width = std::min({types.size(), names.size(), quantities.size(), axes.size()});
  for (size_t k = 0; k + 2 < width; ++k) {
    if (types[k] != "Marker" || quantities[k] != "Position" || axes[k] != "X") continue;
    if (axes[k + 1] != "Y" || axes[k + 2] != "Z") continue;
    markers.push_back({std::string(names[k]), k});
  }
  return markers;
}

}  // namespace

CaptureTable CaptureTableOf(const std::filesystem::path& file) {
  const std::string content = ReadFilledText(file);
  if (content.starts_with("NO_OF_FRAMES\t") || content.starts_with("FILE_VERSION\t"))
    return CaptureTable::kQualisys;
  if (content.starts_with("scorer,")) return CaptureTable::kDeepLabCut;
  return content.starts_with("Format Version,") ? CaptureTable::kMotive : CaptureTable::kNone;
}

MarkerTracks ReadQualisysTsv(const std::filesystem::path& file, FileTimes use) {
  const std::string content = ReadFilledText(file);
  const std::vector<std::string_view> lines = SplitLines(content);
  MarkerTracks tracks;
  tracks.length_unit = "mm";
  double rate = 0;
  double announced = 0;  // number of frames
  size_t row = 0;
  for (; row < lines.size(); ++row) {
    const std::vector<std::string_view> fields = SplitFields(lines[row], '\t');
    if (!IsVariable(fields[0])) break;
    if (fields.size() < 2) continue;
    if (fields[0] == "NO_OF_FRAMES") announced = NumberIn(file, lines[row], row, fields[1]);
    if (fields[0] == "FREQUENCY") rate = ParseNumber(fields[1]).value_or(0);
    if (fields[0] == "DATA_INCLUDED" && fields[1] != "3D")
      FailAt(file, row, fmt::format("holds {} data; export 3D data", fields[1]));
    if (fields[0] == "MARKER_NAMES")
      for (size_t i = 1; i < fields.size(); ++i)
        if (!fields[i].empty()) tracks.names.emplace_back(fields[i]);
  }
  if (tracks.names.empty()) throw InputError({file.string()}, "names no markers (MARKER_NAMES)");
  NumberRepeatedNames(file, &tracks);

  const size_t coordinates = 3 * tracks.names.size();
  size_t before = 0;  // columns in front of the coordinates: none, the frame, or frame and time
  bool has_columns = row < lines.size() && lines[row].starts_with("Frame");
  if (has_columns) {
    const std::vector<std::string_view> fields = SplitFields(lines[row++], '\t');
    before = fields.size() > 1 && fields[1] == "Time" ? 2 : 1;
  }
  std::vector<double> times;
  for (; row < lines.size(); ++row) {
    std::vector<std::string_view> fields = SplitFields(lines[row], '\t');
    if (lines[row].empty()) continue;  // a row of tabs is a frame without any marker
    if (!has_columns) {  // the first row tells how many columns precede the coordinates
      before = ColumnsBefore(fields, coordinates);
      has_columns = true;
    }
    while (fields.size() > coordinates + before && fields.back().empty()) fields.pop_back();
    if (fields.size() != coordinates + before)
      FailAt(file, row,
             fmt::format("has {} entries; expected {} for {} markers", fields.size(),
                         coordinates + before, tracks.names.size()));
    std::vector<MarkerColumnTriple> markers;
    for (size_t m = 0; m < tracks.names.size(); ++m) markers.push_back({"", before + 3 * m});
    AddRow(file, lines[row], row, fields, markers, /*zero_is_unseen=*/true, &tracks);
    if (before == 2)
      times.push_back(NumberIn(file, lines[row], row, fields[1]));
    else if (rate > 0)
      times.push_back(static_cast<double>(tracks.positions.size() - 1) / rate);
  }
  if (announced > 0 && static_cast<double>(tracks.positions.size()) != announced)
    throw InputError({file.string()}, fmt::format("holds {} frames where NO_OF_FRAMES says {}",
                                                  tracks.positions.size(), announced));
  if (tracks.positions.empty()) throw InputError({file.string()}, "holds no frame");
  SetTimes(file, AsTimes(times), rate, use, &tracks);
  return tracks;
}

MarkerTracks ReadMotiveCsv(const std::filesystem::path& file, FileTimes use) {
  const std::string content = ReadFilledText(file);
  const std::vector<std::string_view> lines = SplitLines(content);
  // The rows above the data that are not blank: types, names, perhaps identifiers and parents,
  // quantities, axes.
  std::vector<std::vector<std::string_view>> above;
  size_t row = 1;
  for (; row < lines.size(); ++row) {
    std::vector<std::string_view> fields = SplitFields(lines[row], ',');
    if (AreEmpty(fields)) continue;
    above.push_back(std::move(fields));
    if (above.back()[0] == "Frame") break;
  }
  if (row == lines.size() || above.size() < 4)
    throw InputError({file.string()},
                     "has no rows with the types, names and axes of its columns; export them with "
                     "the header");
  const std::vector<std::string_view>& axes = above.back();
  const std::vector<MarkerColumnTriple> markers =
      MarkersOfMotive(above[0], above[1], above[above.size() - 2], axes);
  if (markers.empty())
    throw InputError({file.string()},
                     "has no columns of the type Marker; positions that a solver has computed "
                     "for rigid bodies and bones are not measurements of a soft object");
  const std::map<std::string, std::string> pairs = PairsIn(lines[0]);
  MarkerTracks tracks;
  tracks.length_unit = UnitOfMotive(pairs);
  for (const MarkerColumnTriple& marker : markers) tracks.names.push_back(marker.name);
  NumberRepeatedNames(file, &tracks);
  const bool has_time = axes.size() > 1 && axes[1].starts_with("Time");
  std::vector<double> times;
  for (++row; row < lines.size(); ++row) {
    const std::vector<std::string_view> fields = SplitFields(lines[row], ',');
    if (AreEmpty(fields)) continue;
    if (fields.size() > axes.size())
      FailAt(file, row, fmt::format("has {} entries; expected {}", fields.size(), axes.size()));
    AddRow(file, lines[row], row, fields, markers, /*zero_is_unseen=*/false, &tracks);
    if (has_time)
      times.push_back(fields.size() > 1 ? NumberIn(file, lines[row], row, fields[1]) : kNotSeen);
  }
  if (tracks.positions.empty()) throw InputError({file.string()}, "holds no frame");
  const auto rate = pairs.find("Export Frame Rate");
  SetTimes(file, AsTimes(times), rate == pairs.end() ? 0 : ParseNumber(rate->second).value_or(0),
           use, &tracks);
  return tracks;
}

MarkerTracks ReadDeepLabCutCsv(const std::filesystem::path& file) {
  const std::string content = ReadFilledText(file);
  const std::vector<std::string_view> lines = SplitLines(content);
  // The rows of names, by their first entry.
  std::map<std::string, std::vector<std::string_view>> above;
  size_t row = 0;
  for (; row < lines.size() && above.count("coords") == 0; ++row) {
    std::vector<std::string_view> fields = SplitFields(lines[row], ',');
    std::string name(fields[0]);
    above[name] = std::move(fields);
  }
  if (above.count("coords") == 0 || above.count("bodyparts") == 0)
    throw InputError({file.string()}, "has no rows bodyparts and coords above its numbers");
  const std::vector<std::string_view>&axes = above["coords"], &parts = above["bodyparts"];
  const std::vector<std::string_view>& individuals = above["individuals"];
  const size_t width = std::min(axes.size(), parts.size());
  std::vector<MarkerColumnTriple> markers;
  bool is_flat = false;
  for (size_t k = 1; k + 1 < width; ++k) {
    if (axes[k] != "x" || axes[k + 1] != "y") continue;
    if (k + 2 >= width || axes[k + 2] != "z") {
      is_flat = true;
      continue;
    }
    const std::string individual = k < individuals.size() ? std::string(individuals[k]) + " " : "";
    markers.push_back({individual + std::string(parts[k]), k});
  }
  if (markers.empty())
    throw InputError(
        {file.string()},
        is_flat ? "gives x and y only, which are pixels of one camera; triangulate the views of "
                  "several (DeepLabCut's triangulate, Anipose) to get points in space"
                : "has no columns x, y, z in its row coords");
  MarkerTracks tracks;
  for (const MarkerColumnTriple& marker : markers) tracks.names.push_back(marker.name);
  NumberRepeatedNames(file, &tracks);
  for (; row < lines.size(); ++row) {
    const std::vector<std::string_view> fields = SplitFields(lines[row], ',');
    if (AreEmpty(fields)) continue;
    if (fields.size() > axes.size())
      FailAt(file, row, fmt::format("has {} entries; expected {}", fields.size(), axes.size()));
    AddRow(file, lines[row], row, fields, markers, /*zero_is_unseen=*/false, &tracks);
  }
  if (tracks.positions.empty()) throw InputError({file.string()}, "holds no frame");
  return tracks;
}

}  // namespace lacuna
