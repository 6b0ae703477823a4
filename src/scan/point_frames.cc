#include "scan/point_frames.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>
#include <unordered_map>

#include "core/error.h"
#include "core/npy.h"
#include "scan/delimited_table.h"
#include "scan/frame_list.h"
#include "scan/frame_points.h"
#include "scan/yaml_format.h"

namespace lacuna {
namespace {

PointColumns ReadPointColumns(const Config& frames) {
  PointColumns columns;
  if (const auto map = frames.OptionalChild("columns")) {
    columns.position = {map->Text("x"), map->Text("y"), map->Text("z")};
    const std::string nx = map->Text("nx", "");
    if (!nx.empty()) columns.normal = {nx, map->Text("ny"), map->Text("nz")};
    const std::string u = map->Text("u", "");
    if (!u.empty()) columns.displacement = {u, map->Text("v"), map->Text("w")};
    if (!u.empty()) columns.sigma = map->Text("sigma", "");
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

// The columns of `points` in the order of `wanted`; NaN for points that the file does not have.
Eigen::Matrix3Xd InOrderOf(const std::vector<double>& wanted, const std::vector<double>& ids,
                           const Eigen::Matrix3Xd& points, const std::filesystem::path& file) {
  std::unordered_map<double, Eigen::Index> row;
  for (size_t i = 0; i < ids.size(); ++i) {
    if (!row.emplace(ids[i], static_cast<Eigen::Index>(i)).second)
      throw InputError({file.string()}, fmt::format("lists the point {} twice", IdText(ids[i])));
  }
  Eigen::Matrix3Xd ordered = Eigen::Matrix3Xd::Constant(3, static_cast<Eigen::Index>(wanted.size()),
                                                        std::numeric_limits<double>::quiet_NaN());
  size_t found = 0;
  for (size_t i = 0; i < wanted.size(); ++i) {
    const auto at = row.find(wanted[i]);
    if (at == row.end()) continue;
    ordered.col(static_cast<Eigen::Index>(i)) = points.col(at->second);
    ++found;
  }
  if (found == 0)
    throw InputError({file.string()},
                     "has none of the points of the first file; their numbers "
                     "differ");
  return ordered;
}

}  // namespace

void ReadSource(const Config& frames, const DataLocation& data, PointFrames* source,
                std::vector<std::string>* warnings) {
  source->world_from_file = ReadWorldFromFile(frames, LengthOf(data.length_unit));
  source->files = OneFilePerFrame(ReadFrameFiles(frames, data.folder));
  ReadObjectChoice(frames, data, source);
  source->columns = ReadPointColumns(frames);
  const CorrelationTable correlation = ReadCorrelationTable(source->files[0][0], source->columns);
  source->tracked = frames.Flag("tracked", correlation.is_read);
  if (source->tracked) source->ids = correlation.ids;
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
  PointCloud raw = ReadPointFile(file, source.columns, &frame->notes, &correlation);
  if (!source.ids.empty()) {
    if (correlation.ids.empty())
      throw InputError({file.string()}, "does not number its points, as the first file does");
    raw.points = InOrderOf(source.ids, correlation.ids, raw.points, file);
  }
  frame->repeated_count = ForgetRepeatedPoints(source.tracked, &raw.points);
  raw.points = source.world_from_file * raw.points;
  ForgetOtherObjects(source, source.connectivity, &raw.points, frame);
  KeepUsablePoints(raw, source.connectivity, frame);
  frame->cloud.normals = UnitNormals(frame->cloud.normals, source.world_from_file.rotation);
  frame->sensors.positions = source.sensors;
  RequirePoints(*frame, kFewestScannedPoints, "is finite");
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
