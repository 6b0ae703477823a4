#include "scan/marker_frames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "core/atomic_file.h"
#include "core/csv_text.h"
#include "core/error.h"
#include "core/first_few.h"
#include "core/quoted_text.h"
#include "scan/frame_points.h"
#include "scan/marker_files.h"
#include "scan/marker_place_table.h"
#include "scan/time_series.h"
#include "scan/track_doubts.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

MarkerColumns ReadMarkerColumns(const Config& frames) {
  MarkerColumns columns;
  columns.time_unit = ReadUnit(frames, "time_unit", kTime, "s");
  const std::optional<Config> map = frames.OptionalChild("columns");
  if (frames.Has("time_unit") && !(map && map->Has("time")))
    frames.Fail("time_unit", "belongs to a column that `columns: {time: …}` names");
  if (!map) return columns;
  columns.time = map->Text("time", "");
  columns.x = map->Text("x", columns.x);
  columns.y = map->Text("y", columns.y);
  columns.z = map->Text("z", columns.z);
  for (const std::string key : {"x", "y", "z"}) {
    const std::string pattern = map->Text(key, "*");
    if (std::count(pattern.begin(), pattern.end(), '*') != 1) {
      map->Fail(key, "expected one star in the place of the marker's name, e.g. \"*_x\"");
    }
  }
  return columns;
}

// A place per marker, m; NaN where `frames` gives none.
Eigen::Matrix3Xd NoPlaces(size_t markers) {
  return Eigen::Matrix3Xd::Constant(3, static_cast<Eigen::Index>(markers),
                                    std::numeric_limits<double>::quiet_NaN());
}

Eigen::Matrix3Xd ReadListedPlaces(const Config& frames, const std::vector<std::string>& names) {
  Eigen::Matrix3Xd places = NoPlaces(names.size());
  for (const Config& item : frames.Items("marker_places")) {
    const std::string name = item.Text("name");
    const auto found = std::find(names.begin(), names.end(), name);
    if (found == names.end()) item.Fail("name", fmt::format("there is no marker {}", name));
    auto place = places.col(found - names.begin());
    if (place.allFinite()) item.Fail("name", "is listed twice");
    place = item.Vector("position", kLength);
  }
  return places;
}

// The places of a table, of which the numbers are multiples of `length`. Rows of other markers are
// not needed: one table may serve several recordings.
Eigen::Matrix3Xd ReadPlaceTable(const std::filesystem::path& file, double length,
                                const std::vector<std::string>& names) {
  Eigen::Matrix3Xd places = NoPlaces(names.size());
  bool has_any = false;
  for (const MarkerPlace& row : ReadMarkerPlaces(file)) {
    const auto found = std::find(names.begin(), names.end(), row.name);
    if (found == names.end()) continue;
    auto place = places.col(found - names.begin());
    if (place.allFinite())
      throw InputError({file.string(), row.line, 1}, fmt::format("{} is listed twice", row.name));
    if (!row.position.allFinite())
      throw InputError({file.string(), row.line, 1},
                       fmt::format("the place of {} is incomplete", row.name));
    place = length * row.position;
    has_any = true;
  }
  if (!has_any)
    throw InputError({file.string()},
                     fmt::format("has no place of any of the markers {}", FirstFew(names)));
  return places;
}

// A warning about markers at exactly (0, 0, 0), which some programs write for "not seen"; empty
// where there are none.
std::string DoubtOfZeros(const MarkerTracks& tracks, const std::filesystem::path& file) {
  std::vector<std::string> doubtful;
  for (size_t m = 0; m < tracks.names.size(); ++m) {
    const auto count = std::count_if(tracks.positions.begin(), tracks.positions.end(),
                                     [m](const Eigen::Matrix3Xd& positions) {
                                       return positions.col(static_cast<Eigen::Index>(m)).isZero(0);
                                     });
    if (count > 0) doubtful.push_back(fmt::format("{} in {}", tracks.names[m], count));
  }
  if (doubtful.empty()) return "";
  return fmt::format(
      "{}: markers are at exactly (0, 0, 0), which counts as a measured position: {} of {} "
      "frames; if it means that a marker was not seen, leave its entries empty",
      file.string(), fmt::join(doubtful, ", "), tracks.positions.size());
}

// A warning about markers that no frame shows; empty where there are none.
std::string DoubtOfUnseen(const MarkerTracks& tracks, const std::filesystem::path& file) {
  std::vector<std::string> unseen;
  for (size_t m = 0; m < tracks.names.size(); ++m) {
    const bool is_seen = std::any_of(
        tracks.positions.begin(), tracks.positions.end(), [m](const Eigen::Matrix3Xd& positions) {
          return positions.col(static_cast<Eigen::Index>(m)).allFinite();
        });
    if (!is_seen) unseen.push_back(tracks.names[m]);
  }
  if (unseen.empty()) return "";
  return fmt::format(
      "{}: markers are not seen in any frame: {}; if they should be, look for empty or wrong "
      "columns; if not, leave them out with `markers` under `frames`",
      file.string(), FirstFew(unseen));
}

void CheckDistances(const MarkerFrames& source, int frame, const Eigen::Matrix3Xd& positions) {
  constexpr double kFarthest = 1e4;  // m, from the origin: no measurement is beyond
  for (Eigen::Index m = 0; m < positions.cols(); ++m) {
    const double distance = positions.col(m).cwiseAbs().maxCoeff();
    if (!(distance > kFarthest)) continue;  // NaN: not seen
    throw InputError({source.file.string()},
                     fmt::format("frame {}: marker {} is {:.3g} m away", frame,
                                 source.tracks.names[static_cast<size_t>(m)], distance));
  }
}

// What stands before the marker's name in the columns of markers.csv. An apostrophe in each of them
// keeps a spreadsheet from evaluating a name like "=1+1", and a blank at the beginning of a name
// from being trimmed. The patterns of `columns` remove it, so that the name is read back as it is.
std::string PrefixOfColumns(const std::vector<std::string>& names) {
  const auto needs_one = [](const std::string& name) {
    return name.starts_with(' ') || IsSpreadsheetFormula(name + "_x");
  };
  return std::any_of(names.begin(), names.end(), needs_one) ? "'" : "";
}

}  // namespace

void ReadSource(const Config& frames, const DataLocation& data, MarkerFrames* source,
                std::vector<std::string>* warnings) {
  source->world_from_file = ReadWorldFromFile(frames, LengthOf(data.length_unit));
  source->file = data.folder / frames.Text("file");
  const bool has_times = frames.Has("rate") || frames.Has("times") || frames.Has("times_file");
  source->tracks = ReadMarkerTracks(source->file, ReadMarkerColumns(frames),
                                    has_times ? FileTimes::kReplaced : FileTimes::kUsed);
  warnings->insert(warnings->end(), source->tracks.warnings.begin(), source->tracks.warnings.end());
  const std::vector<std::string> names = frames.Texts("markers");
  for (size_t i = 0; i < names.size(); ++i) {
    if (std::find(names.begin(), names.begin() + i, names[i]) != names.begin() + i)
      frames.Fail("markers", fmt::format("lists {} twice", names[i]));
  }
  if (!names.empty()) source->tracks = SelectMarkers(source->tracks, names, source->file);
  for (auto* doubt_of : {DoubtOfZeros, DoubtOfUnseen})
    if (std::string doubt = doubt_of(source->tracks, source->file); !doubt.empty())
      warnings->push_back(std::move(doubt));
  if (frames.Has("marker_places_file")) {
    if (frames.Has("marker_places"))
      frames.Fail("marker_places_file", "give this or `marker_places`, not both");
    source->places_file = data.folder / frames.Text("marker_places_file");
    source->places =
        ReadPlaceTable(source->places_file, LengthOf(data.length_unit), source->tracks.names);
  } else {
    source->places = ReadListedPlaces(frames, source->tracks.names);
  }
  const std::string& unit = source->tracks.length_unit;
  if (!unit.empty() && unit != data.length_unit) {
    warnings->push_back(fmt::format("{} says that its lengths are in {}; recording.yaml says {}",
                                    source->file.string(), unit, data.length_unit));
  }
}

std::vector<std::string> DoubtsOfFirstFrame(const Frame&, const MarkerFrames& source) {
  return DoubtsOfTracks(source.tracks, source.file);
}

std::vector<std::filesystem::path> AllFiles(const MarkerFrames& source) {
  if (source.places_file.empty()) return {source.file};
  return {source.file, source.places_file};
}

std::vector<double> TimesInFiles(const MarkerFrames& source) {
  return {source.tracks.times.begin(), source.tracks.times.end()};
}

void KeepFrames(const std::vector<int>& chosen, MarkerFrames* source) {
  MarkerTracks& tracks = source->tracks;
  std::vector<Eigen::Matrix3Xd> positions;
  for (const int i : chosen) {
    positions.push_back(source->world_from_file * tracks.positions[i]);
    CheckDistances(*source, i, positions.back());
  }
  tracks.positions = std::move(positions);
  if (tracks.times.size() > 0) tracks.times = Eigen::VectorXd(tracks.times(chosen));
  tracks.length_unit = "m";
}

void LoadPoints(const MarkerFrames& source, Frame* frame) {
  KeepUsablePoints({source.tracks.positions[frame->index], Eigen::Matrix3Xd(3, 0)},
                   Eigen::Matrix3Xi(3, 0), frame);
  RequirePoints(*frame, 1, "is finite");
}

Markers NamedMarkers(const MarkerFrames& source) {
  return {source.tracks.names, source.places, source.tracks.positions};
}

std::string ExplainSize(const MarkerFrames&, double size, const std::string& length_unit) {
  return ExplainSize(FileFrames(), size, length_unit);
}

std::vector<InfoLine> DescribeSource(const MarkerFrames& source) {
  return {{"markers", fmt::format("{}", fmt::join(source.tracks.names, ", "))}};
}

std::string WriteMarkerFrames(const std::filesystem::path& folder, const std::vector<double>& times,
                              const Markers& markers) {
  CHECK_EQ(times.size(), markers.positions.size());
  const std::string prefix = PrefixOfColumns(markers.names);
  std::string csv = "t";
  for (const std::string& name : markers.names) {
    if (name.find_first_of("\r\n") != std::string::npos)
      throw InputError(
          fmt::format("the name of marker {} has a line break, which a table cannot "
                      "have in the name of a column",
                      QuotedText(name)));
    for (const char axis : {'x', 'y', 'z'})
      csv += "," + VerbatimCsvField(fmt::format("{}{}_{}", prefix, name, axis));
  }
  for (size_t i = 0; i < times.size(); ++i) {
    csv += fmt::format("\n{}", times[i]);
    for (const double coordinate : markers.positions[i].reshaped())
      csv += fmt::format(",{:.9f}", coordinate);
  }
  WriteFileAtomically(folder / "markers.csv", csv + "\n");
  std::string columns = "time: t";
  if (!prefix.empty())
    for (const char axis : {'x', 'y', 'z'})
      columns += fmt::format(", {}: \"{}*_{}\"", axis, prefix, axis);
  std::string yaml = fmt::format(
      "  kind: markers\n  file: markers.csv\n  columns: {{{}}}\n  marker_places:\n", columns);
  for (size_t m = 0; m < markers.names.size(); ++m) {
    const Eigen::Vector3d place = markers.places.col(static_cast<Eigen::Index>(m));
    yaml += fmt::format("    - {{name: {}, position: {}}}\n", QuotedText(markers.names[m]),
                        FormatVector(place, "m"));
  }
  return yaml;
}

}  // namespace lacuna
