#include "scan/point_frames.h"

#include <fmt/format.h>

#include <cmath>

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

}  // namespace

void ReadSource(const Config& frames, const DataLocation& data, PointFrames* source,
                std::vector<std::string>*) {
  source->world_from_file = ReadWorldFromFile(frames, LengthOf(data.length_unit));
  source->files = OneFilePerFrame(ReadFrameFiles(frames, data.folder));
  ReadObjectChoice(frames, data, source);
  source->tracked = frames.Flag("tracked", false);
  source->columns = ReadPointColumns(frames);
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
  PointCloud raw = ReadPointFile(source.files[frame->index][0], source.columns, &frame->notes);
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
