#include "scan/depth_frames.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <glog/logging.h>

#include <cmath>
#include <map>
#include <numbers>

#include "core/error.h"
#include "scan/camera_doubts.h"
#include "scan/camera_reader.h"
#include "scan/frame_list.h"
#include "scan/frame_points.h"
#include "scan/similarity.h"

namespace lacuna {
namespace {

constexpr double kMaxCount = 65534;  // the largest 16-bit number but that of saturated pixels

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

// The points of each camera (world frame), evenly thinned to what a fit of six unknowns needs.
std::vector<Eigen::Matrix3Xd> ThinnedViews(const Frame& frame, size_t camera_count) {
  constexpr Eigen::Index kEnough = 20'000;
  std::vector<Eigen::Matrix3Xd> views;
  for (size_t camera = 0; camera < camera_count; ++camera) {
    std::vector<Eigen::Index> own;
    for (Eigen::Index p = 0; p < frame.cloud.Size(); ++p) {
      if (frame.sensors.seen_by[p] == static_cast<int>(camera)) own.push_back(p);
    }
    const Eigen::Index step = static_cast<Eigen::Index>(own.size()) / kEnough + 1;
    std::vector<Eigen::Index> some;
    for (size_t p = 0; p < own.size(); p += step) some.push_back(own[p]);
    views.push_back(frame.cloud.points(Eigen::all, some));
  }
  return views;
}

std::string Millimetres(double length) { return fmt::format("{:.4g} mm", 1e3 * length); }

std::string DescribeCorrection(const CameraCorrection& correction) {
  if (!correction.applied) return "; " + correction.message;
  std::string text =
      fmt::format("; pose corrected by {} and {:.3g}°, distance to the other views {} → {}",
                  Millimetres(correction.translation), correction.angle * 180 / std::numbers::pi,
                  Millimetres(correction.rms_before), Millimetres(correction.rms_after));
  if (correction.free_directions > 0) {
    text += fmt::format(", {} of 6 degrees of freedom left as given", correction.free_directions);
  }
  return text;
}

std::string FormatPose(const Eigen::Isometry3d& pose) {
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows = pose.matrix();
  return fmt::format("[{}]", fmt::join(rows.data(), rows.data() + 16, ", "));
}

// The intrinsics of a camera belong to one size of its images.
void RequireSize(const DepthImage& depth, const std::filesystem::path& file,
                 const std::filesystem::path& first) {
  const Eigen::Vector2i size = DepthPngSize(first);
  if (depth.cols() == size[0] && depth.rows() == size[1]) return;
  throw InputError({file.string()},
                   fmt::format("has {} × {} pixels where {} of the same camera has {} × {}; "
                               "the intrinsics are valid for one size only",
                               depth.cols(), depth.rows(), first.string(), size[0], size[1]));
}

std::string FormatDepthFrames(size_t count, const VirtualScan& scan) {
  std::string yaml =
      fmt::format("  kind: depth\n  depth_unit: {} m\n  cameras:\n", scan.options.quantum);
  for (size_t c = 0; c < scan.cameras.size(); ++c) {
    const Camera& camera = scan.cameras[c].camera;
    const Intrinsics& k = camera.intrinsics;
    yaml += fmt::format(
        "    - name: {}\n      pattern: frames/camera{}_%03d.png\n      count: {}\n"
        "      intrinsics: {{fx: {}, fy: {}, cx: {}, cy: {}}}\n      world_from_camera: {}\n",
        camera.name, c + 1, count, k.fx, k.fy, k.cx, k.cy, FormatPose(camera.world_from_camera));
  }
  return yaml;
}

}  // namespace

void ReadSource(const Config& frames, const DataLocation& data, DepthFrames* source,
                std::vector<std::string>*) {
  source->depth_unit = frames.Quantity("depth_unit", kLength, kPositive);
  source->min_depth = frames.Quantity("min_depth", kLength, kNotNegative, source->min_depth);
  source->max_depth = frames.Quantity("max_depth", kLength, kPositive, source->max_depth);
  for (const Config& item : frames.Items("cameras")) {
    const std::vector<std::filesystem::path> own = ReadFrameFiles(item, data.folder);
    if (!source->cameras.empty() && own.size() != source->files.size()) {
      item.Fail("", fmt::format("has {} frames where the cameras before have {}", own.size(),
                                source->files.size()));
    }
    source->files.resize(own.size());
    for (size_t i = 0; i < own.size(); ++i) source->files[i].push_back(own[i]);
    if (source->cameras.empty()) source->poses_are_inverse = item.Has("camera_from_world");
    source->cameras.push_back(ReadCamera(item, LengthOf(data.length_unit), source->cameras.size()));
  }
  if (source->cameras.empty()) frames.Fail("cameras", "expected at least one camera");
  source->alignment = ReadAlignment(frames);
  ReadObjectChoice(frames, data, source);
}

void LoadPoints(const DepthFrames& source, Frame* frame) {
  const size_t count = source.cameras.size();
  frame->sensors.positions.resize(3, count);
  std::vector<PointCloud> views(count);
  Eigen::Index total = 0;
  for (size_t c = 0; c < count; ++c) {
    const Camera& camera = source.cameras[c];
    const std::filesystem::path& file = source.files[frame->index][c];
    const DepthImage depth = ReadDepthPng(file, source.depth_unit);
    if (frame->index > 0) RequireSize(depth, file, source.files[0][c]);
    views[c] = BackProject(depth, camera, source.min_depth, source.max_depth);
    frame->sensors.positions.col(c) = camera.world_from_camera.translation();
    frame->row_count += (depth.array() > 0).count();
    total += views[c].Size();
  }
  frame->cloud.points.resize(3, total);
  frame->cloud.normals.resize(3, 0);
  frame->sensors.seen_by.resize(total);
  Eigen::Index at = 0;
  for (size_t c = 0; c < count; ++c) {
    frame->cloud.points.middleCols(at, views[c].Size()) = views[c].points;
    frame->sensors.seen_by.segment(at, views[c].Size()).setConstant(static_cast<int>(c));
    at += views[c].Size();
  }
  ForgetOtherObjects(source, Eigen::Matrix3Xi(3, 0), &frame->cloud.points, frame);
  if (frame->cropped_count + frame->separate_count > 0) {
    std::vector<Eigen::Index> kept;
    for (Eigen::Index p = 0; p < total; ++p) {
      if (frame->cloud.points.col(p).allFinite()) kept.push_back(p);
    }
    frame->cloud.points = frame->cloud.points(Eigen::all, kept).eval();
    frame->sensors.seen_by = frame->sensors.seen_by(kept).eval();
  }
  frame->dropped_count = frame->row_count - frame->cloud.Size();
  RequirePoints(*frame, kFewestScannedPoints, "lies within min_depth and max_depth");
}

bool RefineByFirstFrame(const Frame& first, DepthFrames* source,
                        std::vector<std::string>* warnings) {
  if (!source->alignment) return false;
  source->corrections = AlignCameras(ThinnedViews(first, source->cameras.size()),
                                     first.sensors.positions, *source->alignment);
  for (size_t i = 0; i < source->cameras.size(); ++i) {
    Camera& camera = source->cameras[i];
    const CameraCorrection& correction = source->corrections[i];
    camera.world_from_camera = correction.correction * camera.world_from_camera;
    if (correction.applied) {
      LOG(INFO) << camera.name << ": pose corrected by " << correction.translation << " m and "
                << correction.angle << " rad; distance to the other views " << correction.rms_before
                << " → " << correction.rms_after << " m";
    } else if (i > 0) {
      warnings->push_back(fmt::format("{}: pose refinement {}", camera.name, correction.message));
    }
  }
  return true;
}

std::vector<std::string> DoubtsOfFirstFrame(const Frame& first, const DepthFrames& source) {
  std::vector<std::string> doubts;
  std::map<std::string, std::vector<std::string>> cameras_of_doubt;
  for (size_t c = 0; c < source.cameras.size(); ++c) {
    const Eigen::Vector2i size = DepthPngSize(source.files[first.index][c]);
    const std::string doubt = DoubtOfIntrinsics(source.cameras[c].intrinsics, size[0], size[1]);
    if (!doubt.empty()) cameras_of_doubt[doubt].push_back(source.cameras[c].name);
  }
  for (const auto& [doubt, names] : cameras_of_doubt)
    doubts.push_back(fmt::format("{}: {}", fmt::join(names, ", "), doubt));
  std::vector<Eigen::Matrix3Xd> views;
  for (size_t c = 0; c < source.cameras.size(); ++c) {
    std::vector<Eigen::Index> own;
    for (Eigen::Index p = 0; p < first.cloud.Size(); ++p) {
      if (first.sensors.seen_by[p] == static_cast<int>(c)) own.push_back(p);
    }
    views.push_back(first.cloud.points(Eigen::all, own));
  }
  const std::string doubt = DoubtOfPoses(views, source.cameras, source.poses_are_inverse);
  if (!doubt.empty()) doubts.push_back(doubt);
  return doubts;
}

std::string ExplainSize(const DepthFrames& source, double size, const std::string& length_unit) {
  // Where the distances between the cameras make up the size, it is that of their poses.
  Eigen::AlignedBox3d cameras;
  for (const Camera& camera : source.cameras)
    cameras.extend(camera.world_from_camera.translation().eval());
  const double apart = cameras.diagonal().norm();
  if (apart < size / 4) return "; check depth_unit";
  return fmt::format(
      "; check length_unit, {}, in which the translations of the cameras are read: "
      "these are {:.3g} m apart",
      length_unit, apart);
}

std::vector<InfoLine> DescribeSource(const DepthFrames& source) {
  std::vector<InfoLine> lines;
  for (size_t i = 0; i < source.cameras.size(); ++i) {
    const Camera& camera = source.cameras[i];
    const Eigen::Vector3d position = camera.world_from_camera.translation();
    std::string value = fmt::format("{} at ({:g}, {:g}, {:g}) m", camera.name, position.x(),
                                    position.y(), position.z());
    if (i < source.corrections.size()) value += DescribeCorrection(source.corrections[i]);
    lines.emplace_back("camera", value);
  }
  return lines;
}

std::string WriteDepthFrames(const std::filesystem::path& folder, const VirtualScan& scan) {
  const double quantum = scan.options.quantum;
  if (quantum <= 0) {
    throw InputError("depth images need a quantum > 0: one count of their 16 bits");
  }
  for (size_t i = 0; i < scan.surfaces.size(); ++i) {
    for (size_t c = 0; c < scan.cameras.size(); ++c) {
      const VirtualCamera& camera = scan.cameras[c];
      const DepthImage depth = Measure(Render(scan.surfaces[i], camera), camera, scan.options,
                                       static_cast<int>(i), static_cast<int>(c));
      if (depth.maxCoeff() > kMaxCount * quantum) {
        throw InputError(
            fmt::format("a depth of {:g} m does not fit in 16 bits with a quantum of {:g} m",
                        depth.maxCoeff(), quantum));
      }
      WriteDepthPng(folder / "frames" / fmt::format("camera{}_{:03d}.png", c + 1, i), depth,
                    quantum);
    }
  }
  return FormatDepthFrames(scan.surfaces.size(), scan);
}

}  // namespace lacuna
