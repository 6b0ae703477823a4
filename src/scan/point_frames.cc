#include "scan/point_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <utility>

#include "core/error.h"
#include "core/npy.h"
#include "geometry/nearest.h"
#include "geometry/tri_mesh.h"
#include "scan/column_units.h"
#include "scan/delimited_table.h"
#include "scan/frame_list.h"
#include "scan/frame_points.h"
#include "scan/table_header.h"
#include "scan/time_series.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

PointColumns ReadPointColumns(const Config& frames) {
  PointColumns columns;
  if (const auto map = frames.OptionalChild("columns")) {
    columns.id = map->Text("id", "");
    // One file with all frames may name the columns of its steps alone.
    if (!map->Has("x") && (map->Has("step") || map->Has("time"))) return columns;
    columns.position = {map->Text("x"), map->Text("y"), map->Text("z")};
    const std::string nx = map->Text("nx", "");
    if (!nx.empty()) columns.normal = {nx, map->Text("ny"), map->Text("nz")};
    const std::string u = map->Text("u", "");
    if (!u.empty()) columns.displacement = {u, map->Text("v"), map->Text("w")};
    if (!u.empty())
      columns.positions_are_deformed =
          map->Choice<bool>("places", {{"reference", false}, {"deformed", true}}, "reference");
    if (!u.empty()) columns.sigma = map->Text("sigma", "");
    if (!u.empty()) columns.status = map->Text("status", "");
  }
  return columns;
}

Eigen::Matrix3Xi ReadConnectivity(const std::filesystem::path& file) {
  const Eigen::MatrixXd rows =
      file.extension() == ".npy" ? ReadNpyMatrix(file) : ReadDelimitedTable(file).values;
  if (rows.cols() != 3) {
    throw InputError({file.string()},
                     fmt::format("has {} columns; a triangle has three corners", rows.cols()));
  }
  for (const double corner : rows.reshaped()) {
    if (!(corner >= 0 && corner < 2e9 && corner == std::floor(corner))) {
      throw InputError({file.string()},
                       fmt::format("got {} as a corner; expected a whole number ≥ 0", corner));
    }
  }
  return rows.cast<int>().transpose();
}

std::string IdText(double id) { return fmt::format("{}", id); }

// The rows of a file whose points have the numbers `ids` in the order of `wanted`; −1 for points
// that the file does not have.
std::vector<Eigen::Index> RowsOf(const std::vector<double>& wanted, const std::vector<double>& ids,
                                 const std::filesystem::path& file) {
  std::unordered_map<double, Eigen::Index> row;
  for (size_t i = 0; i < ids.size(); ++i) {
    if (!row.emplace(ids[i], static_cast<Eigen::Index>(i)).second)
      throw InputError({file.string()}, fmt::format("lists the point {} twice", IdText(ids[i])));
  }
  std::vector<Eigen::Index> rows;
  bool is_found = false;
  for (const double id : wanted) {
    const auto at = row.find(id);
    rows.push_back(at == row.end() ? -1 : at->second);
    is_found = is_found || rows.back() >= 0;
  }
  if (!is_found)
    throw InputError({file.string()},
                     "has none of the points of the first file; their numbers "
                     "differ");
  return rows;
}

// The places of the first frame, which identify its points. A failed point at (0, 0, 0) has none.
Eigen::Matrix3Xd KnownPlaces(const CorrelationTable& correlation) {
  Eigen::Matrix3Xd places = correlation.places;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    const bool is_failed = !correlation.points.col(i).allFinite() && places.col(i).isZero(0);
    if (is_failed || !places.col(i).allFinite())
      places.col(i).setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return places;
}

// The distance within which two places are the same: a small part of the spacing of the points.
double SamePlaceDistance(const Eigen::Matrix3Xd& places) {
  constexpr double kShare = 0.05;
  return kShare * BoundingBoxDiagonal(places) / std::sqrt(static_cast<double>(places.cols()));
}

// The rows of a file whose points have the places `wanted` in the reference state, in this order;
// −1 for points that the file does not have.
std::vector<Eigen::Index> RowsAt(const Eigen::Matrix3Xd& wanted,
                                 const CorrelationTable& correlation,
                                 const std::filesystem::path& file) {
  const Eigen::Matrix3Xd &places = correlation.places, &points = correlation.points;
  std::vector<Eigen::Index> known, usable;
  for (Eigen::Index i = 0; i < wanted.cols(); ++i)
    if (wanted.col(i).allFinite()) known.push_back(i);
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    if (points.col(i).allFinite() && places.col(i).allFinite()) usable.push_back(i);
  const Eigen::Matrix3Xd known_places = wanted(Eigen::all, known);
  const double same = known.empty() ? 0 : SamePlaceDistance(known_places);
  // A point that failed in the first frame has a row there, but no place.
  const bool is_in_order =
      places.cols() == wanted.cols() &&
      std::all_of(usable.begin(), usable.end(), [&](Eigen::Index i) {
        return !wanted.col(i).allFinite() || (wanted.col(i) - places.col(i)).norm() <= same;
      });
  std::vector<Eigen::Index> rows(static_cast<size_t>(wanted.cols()), -1);
  if (is_in_order) {
    std::iota(rows.begin(), rows.end(), 0);
    return rows;
  }
  bool is_found = false;
  if (!known.empty() && !usable.empty()) {
    const PointHits hits = PointSearch(known_places).Nearest(places(Eigen::all, usable));
    for (size_t k = 0; k < usable.size(); ++k) {
      const Eigen::Index column = static_cast<Eigen::Index>(k);
      if (hits.distance(0, column) > same) continue;
      rows[static_cast<size_t>(known[static_cast<size_t>(hits.index(0, column))])] = usable[k];
      is_found = true;
    }
  }
  if (!is_found)
    throw InputError({file.string()},
                     "has no point at a position of the first file, so that its points cannot "
                     "be identified: either their positions in the reference state differ, or "
                     "they are those of the deformed state, for which `columns` needs `places: "
                     "deformed`");
  return rows;
}

// The columns of `values` in that order; NaN where there are none.
Eigen::MatrixXd InOrder(const std::vector<Eigen::Index>& rows, const Eigen::MatrixXd& values) {
  Eigen::MatrixXd ordered =
      Eigen::MatrixXd::Constant(values.rows(), static_cast<Eigen::Index>(rows.size()),
                                std::numeric_limits<double>::quiet_NaN());
  for (size_t i = 0; i < rows.size(); ++i)
    if (rows[i] >= 0) ordered.col(static_cast<Eigen::Index>(i)) = values.col(rows[i]);
  return ordered;
}

// One file of which each step is a frame.
void ReadSteps(const Config& frames, const DataLocation& data, PointFrames* source) {
  const std::optional<Config> columns = frames.OptionalChild("columns");
  const std::string time = columns ? columns->Text("time", "") : "";
  const std::string step = columns ? columns->Text("step", time) : "";
  if (step.empty())
    frames.Fail("file",
                "one file can hold all frames only if `columns: {step: …}` or `{time: …}` "
                "names the column that tells them apart; list separate files of the frames "
                "under `files`");
  const std::filesystem::path file = data.folder / frames.Text("file");
  if (!std::filesystem::is_regular_file(file))
    frames.Fail("file", "there is no file " + file.string());
  auto steps =
      std::make_shared<SteppedTable>(DivideIntoSteps(ReadDelimitedTable(file), step, time));
  const double unit = ReadUnit(frames, "time_unit", kTime, "s");
  if (!time.empty())
    RefuseOtherUnit(steps->table, RequireColumn(steps->table, time), unit, kTime, "time_unit");
  for (double& at : steps->times) at *= unit;
  source->files.assign(steps->rows.size(), {file});
  source->step.resize(steps->rows.size());
  std::iota(source->step.begin(), source->step.end(), 0);
  source->steps = std::move(steps);
}

// The times in the headers of the files: those of the value that `header: {time: …}` names, or else
// of "time" or "relative_time", where all files have it.
std::vector<double> ReadHeaderTimes(const Config& frames, const PointFrames& source) {
  const std::vector<std::filesystem::path> files = FilesWithHeaders(source);
  if (const auto header = frames.OptionalChild("header")) {
    const std::string name = header->Text("time");
    const double unit = ReadUnit(*header, "time_unit", kTime, "s");
    return HeaderValuesOf(files, name, unit, header->Text("time_unit", "s"));
  }
  if (files.size() < 2) return {};
  std::vector<double> times;
  for (const std::filesystem::path& file : files) {
    const auto values = ReadHeaderValues(file);
    auto found = values.find("time");
    if (found == values.end()) found = values.find("relative_time");
    if (found == values.end() || !(found->second.unit.empty() || found->second.unit == "s"))
      return {};
    times.push_back(found->second.value);
  }
  return times;
}

PointCloud PointsOfFrame(const PointFrames& source, int frame, std::vector<std::string>* notes,
                         CorrelationTable* correlation) {
  const size_t i = static_cast<size_t>(frame);
  if (!source.steps) return ReadPointFile(source.files[i][0], source.columns, notes, correlation);
  return PointsOfTable(TableOfStep(*source.steps, source.step[i]), source.columns, notes,
                       correlation);
}

// A doubt whether the places of a table of image correlation are those of the reference state or of
// the deformed one, from two frames of it: the former are the same in both, the latter differ by
// the change of the displacement. Empty where there is none.
std::string DoubtOfPlaces(const CorrelationTable& first, const CorrelationTable& last,
                          const std::filesystem::path& file) {
  std::vector<Eigen::Index> rows;
  try {
    if (!first.ids.empty() && !last.ids.empty()) rows = RowsOf(first.ids, last.ids, file);
  } catch (const InputError&) {
    return "";  // LoadPoints reports it
  }
  if (rows.empty())
    for (Eigen::Index i = 0; i < std::min(first.places.cols(), last.places.cols()); ++i)
      rows.push_back(i);
  double moved = 0, displaced = 0, apart = 0;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i] < 0) continue;
    const Eigen::Index row = static_cast<Eigen::Index>(i);
    const Eigen::Vector3d move = last.places.col(rows[i]) - first.places.col(row);
    const Eigen::Vector3d change = last.displacements.col(rows[i]) - first.displacements.col(row);
    if (!move.allFinite() || !change.allFinite()) continue;
    moved += move.squaredNorm();
    displaced += change.squaredNorm();
    apart += (move - change).squaredNorm();
  }
  // Either is exact but for rounding, so that a quarter of the squares decides.
  constexpr double kShare = 0.25;
  if (!first.places_are_deformed && moved > kShare * displaced && apart < kShare * moved)
    return fmt::format(
        "{}: the positions change from frame to frame as the displacements do, so they are "
        "probably those of the deformed state; they are read as those of the reference state "
        "unless `columns` says `places: deformed`",
        file.string());
  if (first.places_are_deformed && displaced > 0 && moved < kShare * displaced)
    return fmt::format(
        "{}: the positions are the same in all frames, so they are probably those of the "
        "reference state; they are read as those of the deformed state unless `columns` names "
        "them",
        file.string());
  return "";
}

// Brings the normals of the file into the world frame. Notes it where they cannot be used. Only
// those of scans are estimated later.
void UseGivenNormals(const PointFrames& source, const std::filesystem::path& file, Frame* frame) {
  const Eigen::Index given = frame->cloud.normals.cols();
  const Eigen::Index zero = (frame->cloud.normals.colwise().norm().array() == 0).count();
  frame->cloud.normals = UnitNormals(frame->cloud.normals, source.world_from_file.rotation);
  if (zero > 0)
    frame->notes.push_back(fmt::format(
        "{}: {} of {} normals are zero, so none of the given normals is used{}", file.string(),
        zero, given, source.tracked ? "" : ": all are estimated from the points"));
}

}  // namespace

void ReadSource(const Config& frames, const DataLocation& data, PointFrames* source,
                std::vector<std::string>* warnings) {
  source->world_from_file = ReadWorldFromFile(frames, LengthOf(data.length_unit));
  source->columns = ReadPointColumns(frames);
  if (frames.Has("file"))
    ReadSteps(frames, data, source);
  else
    source->files = OneFilePerFrame(ReadFrameFiles(frames, data.folder));
  ReadObjectChoice(frames, data, source);
  const bool has_times = frames.Has("rate") || frames.Has("times") || frames.Has("times_file");
  if (has_times && frames.Has("header"))
    frames.Fail("header",
                "the times are given more than once: keep one of header, rate, times, "
                "times_file");
  if (!has_times) source->header_times = ReadHeaderTimes(frames, *source);
  CorrelationTable correlation;
  if (source->steps)
    PointsOfFrame(*source, 0, nullptr, &correlation);
  else
    correlation = ReadCorrelationTable(source->files[0][0], source->columns);
  if (correlation.is_read && source->files.size() > 1) {
    CorrelationTable last;
    if (source->steps)
      PointsOfFrame(*source, static_cast<int>(source->files.size()) - 1, nullptr, &last);
    else
      last = ReadCorrelationTable(source->files.back()[0], source->columns);
    const std::string doubt =
        last.is_read ? DoubtOfPlaces(correlation, last, source->files.back()[0]) : "";
    if (!doubt.empty()) warnings->push_back(doubt);
  }
  source->tracked = frames.Flag("tracked", correlation.is_read);
  if (source->tracked) source->ids = correlation.ids;
  if (source->tracked && correlation.is_read && correlation.ids.empty() &&
      !correlation.places_are_deformed)
    source->places = KnownPlaces(correlation);
  const std::string& unit = correlation.length_unit;
  if (!unit.empty() && unit != data.length_unit) {
    warnings->push_back(fmt::format("{} says that its lengths are in {}; recording.yaml says {}",
                                    source->files[0][0].string(), unit, data.length_unit));
  }
  const std::string triangles = frames.Text("triangles", "");
  if (!triangles.empty()) {
    source->connectivity_file = data.folder / triangles;
    source->connectivity = ReadConnectivity(source->connectivity_file);
    source->tracked = true;
  }
  const std::vector<Config> sensors = frames.Items("sensors");
  source->sensors.resize(3, sensors.size());
  for (size_t i = 0; i < sensors.size(); ++i) {
    source->sensors.col(i) = sensors[i].Vector("position", kLength);
  }
}

void LoadPoints(const PointFrames& source, Frame* frame) {
  const std::filesystem::path& file = source.files[frame->index][0];
  CorrelationTable correlation;
  PointCloud raw = PointsOfFrame(source, frame->index, &frame->notes, &correlation);
  std::vector<Eigen::Index> rows;
  if (!source.ids.empty()) {
    if (correlation.ids.empty())
      throw InputError({file.string()}, "does not number its points, as the first file does");
    rows = RowsOf(source.ids, correlation.ids, file);
  } else if (source.places.cols() > 0 && correlation.is_read) {
    rows = RowsAt(source.places, correlation, file);
  }
  if (!rows.empty()) {
    raw.points = InOrder(rows, raw.points);
    if (correlation.sigma.size() > 0)
      correlation.sigma = InOrder(rows, correlation.sigma.transpose()).transpose();
  }
  frame->repeated_count = ForgetRepeatedPoints(source.tracked, &raw.points);
  raw.points = source.world_from_file * raw.points;
  ForgetOtherObjects(source, source.connectivity, &raw.points, frame);
  KeepUsablePoints(raw, source.connectivity, frame);
  UseGivenNormals(source, file, frame);
  if (correlation.sigma.size() > 0) frame->sigma = correlation.sigma(frame->source_row);
  frame->sensors.positions = source.sensors;
  RequirePoints(*frame, kFewestScannedPoints, "is finite");
}

std::vector<double> TimesInFiles(const PointFrames& source) {
  return source.steps ? source.steps->times : source.header_times;
}

void KeepFrames(const std::vector<int>& chosen, PointFrames* source) {
  KeepFrames(chosen, static_cast<FileFrames*>(source));
  if (!source->steps) return;
  std::vector<size_t> kept;
  for (const int i : chosen) kept.push_back(source->step[static_cast<size_t>(i)]);
  source->step = std::move(kept);
}

std::vector<std::filesystem::path> FilesWithHeaders(const PointFrames& source) {
  if (source.steps) return {};
  return AllFiles(static_cast<const FileFrames&>(source));
}

std::vector<std::filesystem::path> AllFiles(const PointFrames& source) {
  std::vector<std::filesystem::path> files = AllFiles(static_cast<const FileFrames&>(source));
  if (!source.connectivity_file.empty()) files.insert(files.begin(), source.connectivity_file);
  return files;
}

std::string WritePointFrames(const std::filesystem::path& folder, const VirtualScan& scan) {
  for (size_t i = 0; i < scan.surfaces.size(); ++i) {
    const ScanResult seen = Scan(scan.surfaces[i], scan.cameras, scan.options, static_cast<int>(i));
    if (seen.cloud.Size() == 0) {
      throw InputError(fmt::format("frame {}: no virtual camera sees the object", i));
    }
    WritePointFile(folder / "frames" / fmt::format("points_{:03d}.ply", i), seen.cloud);
  }
  std::string yaml =
      fmt::format("  kind: points\n  pattern: frames/points_%03d.ply\n  count: {}\n  sensors:\n",
                  scan.surfaces.size());
  for (const VirtualCamera& camera : scan.cameras) {
    yaml += fmt::format("    - position: {}\n",
                        FormatVector(camera.camera.world_from_camera.translation(), "m"));
  }
  return yaml;
}

}  // namespace lacuna
