#include "scan/frame_reader.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/npy.h"
#include "scan/delimited_table.h"
#include "scan/frame_list.h"

namespace lacuna {
namespace {

void CheckAscending(const Config& config, const std::string& key,
                    const std::vector<double>& times) {
  for (size_t i = 0; i < times.size(); ++i) {
    if (!std::isfinite(times[i]) || (i > 0 && times[i] <= times[i - 1])) {
      config.Fail(
          key, fmt::format("frame {}: the time {} s does not follow the one before", i, times[i]));
    }
  }
}

// The times of all `count` frames in the files.
std::vector<double> ReadTimes(const Config& frames, size_t count, Recording* recording) {
  const Eigen::VectorXd& from_file = recording->markers.times;
  const bool has_rate = frames.Has("rate"), has_times = frames.Has("times");
  const std::optional<Config> file = frames.OptionalChild("times_file");
  if (has_rate + has_times + file.has_value() > 1) {
    frames.Fail("", "the times are given more than once: keep one of rate, times, times_file");
  }
  std::vector<double> times;
  std::string key = "rate";
  if (has_rate) {
    const double rate = frames.Quantity("rate", kRate, {1e-6, 1e9, false, false});
    for (size_t i = 0; i < count; ++i) times.push_back(i / rate);
  } else if (has_times) {
    key = "times";
    times = frames.Quantities("times", kTime, kAnyValue);
  } else if (file) {
    key = "times_file";
    recording->times_file = recording->data_folder / file->Text("file");
    const DelimitedTable table = ReadDelimitedTable(recording->times_file);
    const double unit =
        file->Choice<double>("unit", {{"s", 1}, {"ms", 1e-3}, {"us", 1e-6}, {"min", 60}}, "s");
    const Eigen::VectorXd column =
        unit * table.values.col(RequireColumn(table, file->Text("column", "1")));
    times.assign(column.begin(), column.end());
  } else if (from_file.size() > 0) {
    times.assign(from_file.begin(), from_file.end());
  } else if (count == 1) {
    times = {0};
  } else {
    frames.Fail("", "tells no times; give rate, times or times_file");
  }
  if (times.size() != count) {
    frames.Fail(key, fmt::format("{} times for {} frames", times.size(), count));
  }
  CheckAscending(frames, key, times);
  return times;
}

// The frames with from ≤ time ≤ to, of these each `every`-th.
std::vector<int> ChooseFrames(const Config& frames, const std::vector<double>& times) {
  constexpr double kEver = std::numeric_limits<double>::infinity();
  const double from = frames.Quantity("from", kTime, kAnyValue, -kEver);
  const double to = frames.Quantity("to", kTime, kAnyValue, kEver);
  const int every = frames.Integer("every", 1, 1'000'000, 1);
  std::vector<int> chosen;
  int within = 0;
  for (size_t i = 0; i < times.size(); ++i) {
    if (times[i] < from || times[i] > to) continue;
    if (within++ % every == 0) chosen.push_back(static_cast<int>(i));
  }
  if (chosen.empty()) frames.Fail("from", "leaves no frame");
  return chosen;
}

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

Eigen::Isometry3d ReadPose(const Config& config, const std::string& key, double length_unit) {
  const std::vector<double> numbers = config.Quantities(key, kDimensionless, kAnyValue);
  if (numbers.size() != 16) {
    config.Fail(key,
                fmt::format("got {} numbers; expected a 4 × 4 matrix row by row", numbers.size()));
  }
  using RowMajor = Eigen::Matrix<double, 4, 4, Eigen::RowMajor>;
  const Eigen::Matrix4d matrix = Eigen::Map<const RowMajor>(numbers.data());
  const auto rotation = RotationUpToRounding(matrix.topLeftCorner<3, 3>());
  if (!rotation || matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) {
    config.Fail(key,
                "is not a rigid motion: an orthonormal 3 × 3 block of determinant 1, a "
                "translation, and the last row 0 0 0 1");
  }
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = *rotation;
  pose.translation() = length_unit * matrix.topRightCorner<3, 1>();
  return pose;
}

Camera ReadCamera(const Config& config, double length_unit, size_t number) {
  Camera camera;
  camera.name = config.Text("name", fmt::format("camera {}", number + 1));
  const Config intrinsics = config.Child("intrinsics");
  camera.intrinsics = {intrinsics.Number("fx", kPositive), intrinsics.Number("fy", kPositive),
                       intrinsics.Number("cx", kAnyValue), intrinsics.Number("cy", kAnyValue)};
  const bool to_world = config.Has("world_from_camera");
  if (to_world == config.Has("camera_from_world")) {
    config.Fail("", "expected one pose, either world_from_camera or camera_from_world");
  }
  camera.world_from_camera = to_world
                                 ? ReadPose(config, "world_from_camera", length_unit)
                                 : ReadPose(config, "camera_from_world", length_unit).inverse();
  return camera;
}

// files[frame][camera]
std::vector<std::vector<std::filesystem::path>> ReadDepthFrames(const Config& frames,
                                                                Recording* recording) {
  recording->depth_unit = frames.Quantity("depth_unit", kLength, kPositive);
  recording->min_depth = frames.Quantity("min_depth", kLength, kNotNegative, 0.0);
  recording->max_depth =
      frames.Quantity("max_depth", kLength, kPositive, std::numeric_limits<double>::infinity());
  std::vector<std::vector<std::filesystem::path>> files;
  for (const Config& item : frames.Items("cameras")) {
    const std::vector<std::filesystem::path> own = ReadFrameFiles(item, recording->data_folder);
    if (!recording->cameras.empty() && own.size() != files.size()) {
      item.Fail("", fmt::format("has {} frames where the cameras before have {}", own.size(),
                                files.size()));
    }
    files.resize(own.size());
    for (size_t i = 0; i < own.size(); ++i) files[i].push_back(own[i]);
    recording->cameras.push_back(
        ReadCamera(item, LengthOf(recording->length_unit), recording->cameras.size()));
  }
  if (recording->cameras.empty()) frames.Fail("cameras", "expected at least one camera");
  return files;
}

void ReadMarkerFrames(const Config& frames, Recording* recording) {
  recording->marker_file = recording->data_folder / frames.Text("file");
  MarkerColumns columns;
  if (const auto map = frames.OptionalChild("columns")) {
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
  }
  recording->markers = ReadMarkerTracks(recording->marker_file, columns);
  const std::vector<std::string> names = frames.Texts("markers");
  if (!names.empty()) {
    recording->markers = SelectMarkers(recording->markers, names, recording->marker_file);
  }
  const std::string& told = recording->markers.length_unit;
  if (!told.empty() && told != recording->length_unit) {
    Warn(recording, fmt::format("{} says that its lengths are in {}; recording.yaml says {}",
                                recording->marker_file.string(), told, recording->length_unit));
  }
}

void ChooseMarkerFrames(const std::vector<int>& chosen, Recording* recording) {
  constexpr double kFarthest = 1e4;  // m, from the origin: no measurement is beyond
  std::vector<Eigen::Matrix3Xd> positions;
  for (const int i : chosen) {
    positions.push_back(recording->world_from_file * recording->markers.positions[i]);
    for (Eigen::Index m = 0; m < positions.back().cols(); ++m) {
      const double away = positions.back().col(m).cwiseAbs().maxCoeff();
      if (away > kFarthest)
        throw InputError({recording->marker_file.string()},
                         fmt::format("frame {}: marker {} is {:.3g} m away", i,
                                     recording->markers.names[static_cast<size_t>(m)], away));
    }
  }
  recording->markers.positions = std::move(positions);
  recording->markers.times =
      Eigen::Map<const Eigen::VectorXd>(recording->times.data(), recording->times.size());
  recording->markers.length_unit = "m";
}

void ReadMarkerPlaces(const Config& frames, Recording* recording) {
  const MarkerTracks& markers = recording->markers;
  recording->marker_places =
      Eigen::Matrix3Xd::Constant(3, markers.names.size(), std::numeric_limits<double>::quiet_NaN());
  for (const Config& item : frames.Items("marker_places")) {
    const std::string name = item.Text("name");
    const auto found = std::find(markers.names.begin(), markers.names.end(), name);
    if (found == markers.names.end()) item.Fail("name", fmt::format("there is no marker {}", name));
    auto place = recording->marker_places.col(found - markers.names.begin());
    if (place.allFinite()) item.Fail("name", "is listed twice");
    place = item.Vector("position", kLength);
  }
}

}  // namespace

void Warn(Recording* recording, const std::string& message) {
  recording->warnings.push_back(message);
}

std::vector<double> ReadFrames(const Config& frames, Recording* recording) {
  recording->kind = frames.Choice<FrameKind>("kind", {{"points", FrameKind::kPoints},
                                                      {"mesh", FrameKind::kMesh},
                                                      {"depth", FrameKind::kDepth},
                                                      {"markers", FrameKind::kMarkers}});
  recording->world_from_file.scale = LengthOf(recording->length_unit);
  if (recording->kind != FrameKind::kDepth) {
    const auto transform = ReadTransform(frames, LengthOf(recording->length_unit));
    if (transform) recording->world_from_file = *transform;
  }
  std::vector<std::vector<std::filesystem::path>> files;
  size_t count = 0;
  if (recording->kind == FrameKind::kMarkers) {
    ReadMarkerFrames(frames, recording);
    count = recording->markers.positions.size();
  } else if (recording->kind == FrameKind::kDepth) {
    files = ReadDepthFrames(frames, recording);
    count = files.size();
  } else {
    for (const auto& file : ReadFrameFiles(frames, recording->data_folder)) files.push_back({file});
    count = files.size();
    recording->tracked = frames.Flag("tracked", false);
  }
  if (recording->kind == FrameKind::kPoints) {
    recording->columns = ReadPointColumns(frames);
    const std::string triangles = frames.Text("triangles", "");
    if (!triangles.empty()) {
      recording->connectivity_file = recording->data_folder / triangles;
      recording->connectivity = ReadConnectivity(recording->connectivity_file);
      recording->tracked = true;
    }
    const std::vector<Config> sensors = frames.Items("sensors");
    recording->sensors.resize(3, sensors.size());
    for (size_t i = 0; i < sensors.size(); ++i) {
      recording->sensors.col(i) = sensors[i].Vector("position", kLength);
    }
  }
  const std::vector<double> file_times = ReadTimes(frames, count, recording);
  const std::vector<int> chosen = ChooseFrames(frames, file_times);
  for (const int i : chosen) {
    recording->times.push_back(file_times[i]);
    if (!files.empty()) recording->frame_files.push_back(files[i]);
  }
  if (recording->kind == FrameKind::kMarkers) {
    ChooseMarkerFrames(chosen, recording);
    ReadMarkerPlaces(frames, recording);
  }
  return file_times;
}

}  // namespace lacuna
