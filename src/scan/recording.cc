#include "scan/recording.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/error.h"
#include "geometry/mesh_io.h"
#include "geometry/tri_mesh.h"

namespace lacuna {
namespace {

constexpr Eigen::Index kFewestPoints = 4;  // fewer do not span a shape
// m; a coordinate beyond is a placeholder or an overflow, no measurement.
constexpr double kFarthest = 1e9;

// Keeps the finite points (within kFarthest); `source_row` and the triangles follow.
void DropInvalid(const PointCloud& raw, const Eigen::Matrix3Xi& triangles, Frame* frame) {
  std::vector<int> kept;
  std::vector<int> place(raw.Size(), -1);
  for (int i = 0; i < raw.Size(); ++i) {
    const bool has_normal = !raw.HasNormals() || raw.normals.col(i).allFinite();
    const bool is_place = (raw.points.col(i).array().abs() < kFarthest).all();
    if (!is_place || !has_normal) continue;
    place[i] = static_cast<int>(kept.size());
    kept.push_back(i);
  }
  frame->row_count = raw.Size();
  frame->dropped_count = raw.Size() - static_cast<Eigen::Index>(kept.size());
  frame->source_row = Eigen::Map<const Eigen::VectorXi>(kept.data(), kept.size());
  frame->cloud.points = raw.points(Eigen::all, kept);
  frame->cloud.normals.resize(3, 0);
  if (raw.HasNormals()) frame->cloud.normals = raw.normals(Eigen::all, kept);

  std::vector<Eigen::Vector3i> whole;
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Eigen::Vector3i corners = triangles.col(t);
    if (corners.maxCoeff() >= raw.Size()) {
      throw InputError(fmt::format("triangle {} has the corner {}; the frame has {} rows", t,
                                   corners.maxCoeff(), raw.Size()));
    }
    const Eigen::Vector3i moved(place[corners[0]], place[corners[1]], place[corners[2]]);
    if (moved.minCoeff() >= 0) whole.push_back(moved);
  }
  frame->triangles.resize(3, whole.size());
  for (size_t t = 0; t < whole.size(); ++t) frame->triangles.col(t) = whole[t];
}

// A zero normal is none: a cloud either has them all or estimates them.
Eigen::Matrix3Xd UnitNormals(const Eigen::Matrix3Xd& normals, const Eigen::Matrix3d& rotation) {
  const Eigen::RowVectorXd lengths = normals.colwise().norm();
  if (normals.cols() == 0 || !(lengths.minCoeff() > 0)) return Eigen::Matrix3Xd(3, 0);
  return rotation * (normals.array().rowwise() / lengths.array()).matrix();
}

void LoadPoints(const Recording& recording, Frame* frame) {
  PointCloud raw = ReadPointFile(frame->files[0], recording.columns);
  raw.points = recording.world_from_file * raw.points;
  DropInvalid(raw, recording.connectivity, frame);
  frame->cloud.normals = UnitNormals(frame->cloud.normals, recording.world_from_file.rotation);
  frame->sensors.positions = recording.sensors;
}

void LoadMesh(const Recording& recording, Frame* frame) {
  const TriMeshFile file = ReadTriMesh(frame->files[0]);
  for (const std::string& note : file.notes) LOG(INFO) << frame->files[0] << ": " << note;
  TriMesh mesh = file.mesh;
  mesh.vertices = recording.world_from_file * mesh.vertices;
  DropInvalid({mesh.vertices, Eigen::Matrix3Xd(3, 0)}, mesh.triangles, frame);
  const TriMesh whole{frame->cloud.points, frame->triangles};
  const Eigen::Matrix3Xd normals = VertexNormals(whole);
  if (whole.triangles.cols() > 0) {
    frame->cloud.normals = UnitNormals(normals, Eigen::Matrix3d::Identity());
  }
}

void LoadMarkers(const Recording& recording, Frame* frame) {
  DropInvalid({recording.markers.positions[frame->index], Eigen::Matrix3Xd(3, 0)},
              Eigen::Matrix3Xi(3, 0), frame);
}

void LoadDepth(const Recording& recording, Frame* frame) {
  const size_t count = recording.cameras.size();
  frame->sensors.positions.resize(3, count);
  std::vector<PointCloud> views(count);
  Eigen::Index total = 0;
  for (size_t c = 0; c < count; ++c) {
    const Camera& camera = recording.cameras[c];
    const DepthImage depth = ReadDepthPng(frame->files[c], recording.depth_unit);
    views[c] = BackProject(depth, camera, recording.min_depth, recording.max_depth);
    frame->sensors.positions.col(c) = camera.world_from_camera.translation();
    frame->row_count += (depth.array() > 0).count();
    total += views[c].Size();
  }
  frame->dropped_count = frame->row_count - total;
  frame->cloud.points.resize(3, total);
  frame->cloud.normals.resize(3, 0);
  frame->sensors.seen_by.resize(total);
  Eigen::Index at = 0;
  for (size_t c = 0; c < count; ++c) {
    frame->cloud.points.middleCols(at, views[c].Size()) = views[c].points;
    frame->sensors.seen_by.segment(at, views[c].Size()).setConstant(static_cast<int>(c));
    at += views[c].Size();
  }
}

void CheckCount(const Recording& recording, const Frame& frame) {
  const bool is_marker = recording.kind == FrameKind::kMarkers;
  const Eigen::Index fewest = is_marker ? 1 : kFewestPoints;
  if (frame.row_count == 0) throw InputError("holds no point");
  if (frame.cloud.Size() == 0) {
    throw InputError(recording.kind == FrameKind::kDepth
                         ? fmt::format("none of its {} points lies within min_depth and max_depth",
                                       frame.row_count)
                         : fmt::format("none of its {} points is finite", frame.row_count));
  }
  if (frame.cloud.Size() < fewest) {
    throw InputError(fmt::format("holds {} usable point{}; expected at least {}",
                                 frame.cloud.Size(), frame.cloud.Size() == 1 ? "" : "s", fewest));
  }
}

void CheckTracked(const Recording& recording, const Frame& frame) {
  if (recording.tracked && frame.index > 0 && frame.row_count != recording.row_count) {
    throw InputError(
        fmt::format("holds {} points where frame 0 holds {}; tracked points are the "
                    "same in every frame",
                    frame.row_count, recording.row_count));
  }
}

// "frame 3 of bend: <file>: …", with the file unless the message names it already.
[[noreturn]] void Rethrow(const Recording& recording, const Frame& frame, const InputError& error) {
  std::string message = error.what();
  const std::string file =
      frame.files.empty() ? recording.marker_file.string() : frame.files.front();
  const bool is_named =
      std::any_of(frame.files.begin(), frame.files.end(),
                  [&](const std::string& name) { return message.rfind(name, 0) == 0; });
  if (!is_named) message = fmt::format("{}: {}", file, message);
  throw InputError(fmt::format("frame {} of \"{}\": {}", frame.index, recording.name, message));
}

std::string Millimetres(double length) { return fmt::format("{:.4g} mm", 1e3 * length); }

std::string DescribeFrame(const Frame& frame) {
  const Eigen::Vector3d size = BoundingBox(frame.cloud.points).sizes();
  std::string text =
      fmt::format("{} points, {} × {} × {}", frame.cloud.Size(), Millimetres(size.x()),
                  Millimetres(size.y()), Millimetres(size.z()));
  if (frame.cloud.HasNormals()) text += ", with normals";
  if (frame.triangles.cols() > 0) text += fmt::format(", {} triangles", frame.triangles.cols());
  if (frame.dropped_count > 0) {
    text += fmt::format(", {} of {} dropped (not finite or out of range)", frame.dropped_count,
                        frame.row_count);
  }
  return text;
}

std::string DescribeReference(const ReferenceShape& reference) {
  std::string text = "the first frame";
  if (reference.source == ReferenceSource::kMesh) text = "mesh " + reference.file.string();
  if (reference.source == ReferenceSource::kTetMesh) text = "tet mesh " + reference.file.string();
  if (reference.sheet_thickness > 0) {
    text += fmt::format(", an open sheet {} thick", Millimetres(reference.sheet_thickness));
  }
  return text;
}

std::string DescribeGrip(const RecordedGrip& grip) {
  std::string text = fmt::format("{}: {}", grip.region.name, DescribeRegion(grip.region));
  if (grip.motion == GripMotion::kGiven) return text + ", moves along a given path";
  text += grip.motion == GripMotion::kFollowsScan
              ? ", follows the scan"
              : fmt::format(", follows the markers {}", fmt::join(grip.markers, ", "));
  return text + (grip.deforms ? ", which may deform" : "");
}

const char* KindName(FrameKind kind) {
  switch (kind) {
    case FrameKind::kPoints:
      return "point clouds";
    case FrameKind::kMesh:
      return "triangle meshes";
    case FrameKind::kDepth:
      return "depth images";
    case FrameKind::kMarkers:
      return "marker tracks";
  }
  return "";
}

}  // namespace

Frame LoadFrame(const Recording& recording, int i) {
  CHECK(i >= 0 && i < recording.FrameCount()) << "frame " << i;
  Frame frame;
  frame.index = i;
  frame.time = recording.times[i];
  frame.triangles.resize(3, 0);
  frame.sensors.positions.resize(3, 0);
  if (recording.kind != FrameKind::kMarkers) {
    for (const auto& file : recording.frame_files[i]) frame.files.push_back(file.string());
  }
  try {
    switch (recording.kind) {
      case FrameKind::kPoints:
        LoadPoints(recording, &frame);
        break;
      case FrameKind::kMesh:
        LoadMesh(recording, &frame);
        break;
      case FrameKind::kDepth:
        LoadDepth(recording, &frame);
        break;
      case FrameKind::kMarkers:
        LoadMarkers(recording, &frame);
        break;
    }
    CheckCount(recording, frame);
    CheckTracked(recording, frame);
  } catch (const InputError& error) {
    Rethrow(recording, frame, error);
  }
  LOG_IF(INFO, frame.dropped_count > 0)
      << recording.name << ", frame " << i << ": " << frame.dropped_count << " of "
      << frame.row_count << " points dropped (not finite or out of range)";
  return frame;
}

std::vector<std::filesystem::path> RecordingFiles(const Recording& recording) {
  std::vector<std::filesystem::path> files = {recording.file, recording.times_file,
                                              recording.connectivity_file, recording.marker_file,
                                              recording.reference.file};
  const auto add_region = [&](const Region& region) {
    if (const auto* listed = std::get_if<NodeRegion>(&region.shape)) files.push_back(listed->file);
  };
  for (const Region& region : recording.fixed) add_region(region);
  for (const RecordedGrip& grip : recording.grips) {
    add_region(grip.region);
    files.push_back(grip.file);
  }
  for (const MeasuredForce& force : recording.forces) {
    if (force.region) add_region(*force.region);
    files.push_back(force.file);
  }
  for (const auto& frame : recording.frame_files) {
    files.insert(files.end(), frame.begin(), frame.end());
  }
  std::set<std::filesystem::path> seen = {""};
  std::erase_if(files, [&](const auto& file) { return !seen.insert(file).second; });
  return files;
}

std::string DescribeRecording(const Recording& recording) {
  std::string text = fmt::format("{}\n", recording.name);
  const auto line = [&](const std::string& what, const std::string& value) {
    text += fmt::format("  {:<12} {}\n", what, value);
  };
  line("frames",
       fmt::format("{} {}, {:g} s to {:g} s", recording.FrameCount(), KindName(recording.kind),
                   recording.times.front(), recording.times.back()));
  line("first frame", DescribeFrame(LoadFrame(recording, 0)));
  line("last frame", DescribeFrame(LoadFrame(recording, recording.FrameCount() - 1)));
  if (recording.kind == FrameKind::kMarkers) {
    line("markers", fmt::format("{}", fmt::join(recording.markers.names, ", ")));
  }
  for (size_t i = 0; i < recording.cameras.size(); ++i) {
    const Eigen::Vector3d at = recording.cameras[i].world_from_camera.translation();
    std::string value = fmt::format("{} at ({:g}, {:g}, {:g}) m", recording.cameras[i].name, at.x(),
                                    at.y(), at.z());
    if (i < recording.camera_corrections.size()) {
      const CameraCorrection& correction = recording.camera_corrections[i];
      value += correction.applied
                   ? fmt::format(
                         "; pose corrected by {} and {:.3g}°, distance to the other views "
                         "{} → {}",
                         Millimetres(correction.translation), correction.angle * 180 / M_PI,
                         Millimetres(correction.rms_before), Millimetres(correction.rms_after))
                   : "; " + correction.message;
      if (correction.applied && correction.free_directions > 0) {
        value +=
            fmt::format(", {} of 6 directions of motion left as given", correction.free_directions);
      }
    }
    line("camera", value);
  }
  line("density", recording.density ? fmt::format("{:g} kg/m³", *recording.density) : "not told");
  line("gravity", recording.gravity ? fmt::format("({:g}, {:g}, {:g}) m/s²", recording.gravity->x(),
                                                  recording.gravity->y(), recording.gravity->z())
                                    : "not told");
  line("reference", DescribeReference(recording.reference));
  for (const Region& region : recording.fixed) {
    line("fixed", fmt::format("{}: {}", region.name, DescribeRegion(region)));
  }
  for (const RecordedGrip& grip : recording.grips) line("gripped", DescribeGrip(grip));
  for (const MeasuredForce& force : recording.forces) {
    line("force", fmt::format("{}: {} values, at most {:.4g} N{}", force.name, force.times.size(),
                              force.forces.colwise().norm().maxCoeff(),
                              force.region ? ", on " + DescribeRegion(*force.region) : ""));
  }
  for (const std::string& warning : recording.warnings) line("warning", warning);
  return text;
}

}  // namespace lacuna
