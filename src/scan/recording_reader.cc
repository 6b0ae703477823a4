// recording.yaml → Recording.
#include <fmt/format.h>
#include <glog/logging.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/mesh_io.h"
#include "geometry/tri_mesh.h"
#include "scan/frame_reader.h"
#include "scan/known_forces.h"
#include "scan/recording.h"

namespace lacuna {
namespace {

constexpr int kSchemaVersion = 1;

ReferenceShape ReadReference(const Config& config, const Recording& recording) {
  ReferenceShape reference;
  reference.world_from_file.scale = LengthOf(recording.length_unit);
  const std::optional<Config> given = config.OptionalChild("reference");
  if (!given) {
    if (recording.kind == FrameKind::kMarkers) {
      config.Fail("", "reference: markers do not tell the shape; give a mesh or a tet_mesh");
    }
    return reference;
  }
  reference.source =
      given->Choice<ReferenceSource>("from", {{"first_frame", ReferenceSource::kFirstFrame},
                                              {"mesh", ReferenceSource::kMesh},
                                              {"tet_mesh", ReferenceSource::kTetMesh}});
  if (reference.source != ReferenceSource::kFirstFrame) {
    reference.file = recording.data_folder / given->Text("file");
    // A shape of one's own beside somebody else's data.
    const std::filesystem::path beside = recording.file.parent_path() / given->Text("file");
    if (!std::filesystem::is_regular_file(reference.file) &&
        std::filesystem::is_regular_file(beside)) {
      reference.file = beside;
    }
    if (!std::filesystem::is_regular_file(reference.file)) {
      given->Fail("file", fmt::format("there is no file {}", reference.file.string()));
    }
    const double unit = LengthOf(ReadLengthUnit(*given, recording.length_unit));
    reference.world_from_file.scale = unit;
    if (const auto transform = ReadTransform(*given, unit)) reference.world_from_file = *transform;
  } else if (recording.kind == FrameKind::kMarkers) {
    given->Fail("from", "markers do not tell the shape; give a mesh or a tet_mesh");
  }
  if (const auto sheet = given->OptionalChild("sheet")) {
    if (reference.source == ReferenceSource::kTetMesh) {
      given->Fail("sheet", "a tet_mesh is a solid already");
    }
    reference.sheet_thickness = sheet->Quantity("thickness", kLength, kPositive);
    reference.sheet_face = sheet->Choice<SheetFace>(
        "face", {{"middle", SheetFace::kMiddle}, {"front", SheetFace::kFront}}, "middle");
  }
  return reference;
}

std::optional<AlignmentOptions> ReadAlignment(const Config& frames) {
  const auto config = frames.OptionalChild("refine_alignment");
  if (!config) return std::nullopt;
  AlignmentOptions options;
  options.max_distance = config->Quantity("max_distance", kLength, kPositive, options.max_distance);
  options.max_angle =
      config->Quantity("max_angle", kAngle, {0, 1.5, true, false}, options.max_angle);
  options.sweeps = config->Integer("sweeps", 1, 100, options.sweeps);
  options.iterations = config->Integer("iterations", 1, 10'000, options.iterations);
  options.min_stiffness =
      config->Number("min_stiffness", {0, 1, true, true}, options.min_stiffness);
  options.min_pairs = config->Integer("min_pairs", 6, 10'000'000, options.min_pairs);
  return options;
}

void RefineCameras(const AlignmentOptions& options, Recording* recording) {
  constexpr Eigen::Index kEnough = 20'000;  // points of a camera for a fit of six unknowns
  std::vector<Eigen::Matrix3Xd> clouds;
  Eigen::Matrix3Xd positions(3, recording->cameras.size());
  const Frame first = LoadFrame(*recording, 0);
  for (size_t i = 0; i < recording->cameras.size(); ++i) {
    positions.col(i) = recording->cameras[i].world_from_camera.translation();
    std::vector<Eigen::Index> own;
    for (Eigen::Index p = 0; p < first.cloud.Size(); ++p) {
      if (first.sensors.seen_by[p] == static_cast<int>(i)) own.push_back(p);
    }
    const Eigen::Index step = static_cast<Eigen::Index>(own.size()) / kEnough + 1;
    std::vector<Eigen::Index> some;
    for (size_t p = 0; p < own.size(); p += step) some.push_back(own[p]);
    clouds.push_back(first.cloud.points(Eigen::all, some));
  }
  recording->camera_corrections = AlignCameras(clouds, positions, options);
  for (size_t i = 0; i < recording->cameras.size(); ++i) {
    Camera& camera = recording->cameras[i];
    const CameraCorrection& correction = recording->camera_corrections[i];
    camera.world_from_camera = correction.correction * camera.world_from_camera;
    if (correction.applied) {
      LOG(INFO) << camera.name << ": pose corrected by " << correction.translation << " m and "
                << correction.angle << " rad; distance to the other views " << correction.rms_before
                << " → " << correction.rms_after << " m";
    } else if (i > 0) {
      Warn(recording, fmt::format("{}: pose refinement {}", camera.name, correction.message));
    }
  }
}

// A soft object in front of a scanner is between a few millimetres and some metres wide.
void CheckSize(const Frame& first, Recording* recording) {
  constexpr double kSmall = 2e-3, kLarge = 20;  // m
  if (first.cloud.Size() < 2) return;
  const double size = BoundingBoxDiagonal(first.cloud.points);
  if (size >= kSmall && size <= kLarge) return;
  if (recording->kind == FrameKind::kDepth) {
    Warn(recording, fmt::format("frame 0 is {:.3g} m across; check depth_unit", size));
    return;
  }
  std::string hint;
  for (const std::string unit : {"m", "cm", "mm", "um"}) {
    const double other = size / LengthOf(recording->length_unit) * LengthOf(unit);
    if (other >= 5 * kSmall && other <= kLarge / 5) {
      hint += fmt::format("{} {:.3g} m with length_unit: {}",
                          hint.empty() ? "; it would be" : " or", other, unit);
    }
  }
  Warn(recording, fmt::format("frame 0 is {:.3g} m across with length_unit: {}{}", size,
                              recording->length_unit, hint));
}

// A reference of quite another size than the frames is one of them in the wrong unit.
void CheckReferenceSize(const Frame& first, Recording* recording) {
  constexpr double kFactor = 50;
  const ReferenceShape& reference = recording->reference;
  if (reference.source == ReferenceSource::kFirstFrame || first.cloud.Size() < 2) return;
  const Eigen::Matrix3Xd points = reference.source == ReferenceSource::kMesh
                                      ? ReadTriMesh(reference.file).mesh.vertices
                                      : ReadTetMesh(reference.file).mesh.nodes;
  const double size = BoundingBoxDiagonal(reference.world_from_file * points);
  const double frame_size = BoundingBoxDiagonal(first.cloud.points);
  if (size < kFactor * frame_size && frame_size < kFactor * size) return;
  Warn(recording,
       fmt::format("the reference shape is {:.3g} m across, frame 0 {:.3g} m; check length_unit "
                   "and reference.length_unit",
                   size, frame_size));
}

}  // namespace

Recording LoadRecording(const std::filesystem::path& path) {
  const bool is_folder = std::filesystem::is_directory(path);
  const Config config = Config::Load(is_folder ? path / "recording.yaml" : path);
  config.Integer("schema_version", kSchemaVersion, kSchemaVersion);
  Recording recording;
  recording.file = config.File();
  recording.name = config.Text("name", recording.file.parent_path().filename().string());
  recording.data_folder = config.Path("data_folder", ".");
  if (!std::filesystem::is_directory(recording.data_folder)) {
    config.Fail("data_folder",
                fmt::format("there is no folder {}", recording.data_folder.string()));
  }
  recording.length_unit = ReadLengthUnit(config, "");
  constexpr double kNotTold = std::numeric_limits<double>::quiet_NaN();
  const double density = config.Quantity("density", kDensity, kPositive, kNotTold);
  if (std::isfinite(density)) recording.density = density;
  const Eigen::Vector3d gravity =
      config.Vector("gravity", kAcceleration, Eigen::Vector3d::Constant(kNotTold));
  if (gravity.allFinite()) recording.gravity = gravity;
  const Config frames = config.Child("frames");
  const std::vector<double> file_times = ReadFrames(frames, &recording);
  std::optional<AlignmentOptions> alignment;
  if (recording.kind == FrameKind::kDepth) alignment = ReadAlignment(frames);
  for (const Config& item : config.Items("fixed")) {
    recording.fixed.push_back(ReadRegion(item, recording.data_folder,
                                         fmt::format("fixed {}", recording.fixed.size() + 1)));
  }
  recording.grips = ReadGrips(config, recording, file_times);
  recording.forces = ReadForces(config, recording, file_times);
  recording.reference = ReadReference(config, recording);
  config.RefuseUnknownKeys();
  recording.resolved = config.Resolved().dump();

  if (alignment) RefineCameras(*alignment, &recording);
  const Frame first = LoadFrame(recording, 0);
  recording.row_count = first.row_count;
  CheckSize(first, &recording);
  CheckReferenceSize(first, &recording);
  return recording;
}

}  // namespace lacuna
