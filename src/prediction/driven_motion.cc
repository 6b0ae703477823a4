#include "prediction/driven_motion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "experiment/scan_frames.h"

namespace lacuna {
namespace {

// The object moves in proportion to the path if less than this share of the squares is left.
constexpr double kProportional = 0.1;
// Ratios of the object's motion to the path's that are no mistake. A lever moves farther than what
// drives it; markers may be near the end that is held.
constexpr double kLeastRatio = 0.005, kLargestRatio = 8;
// Points of a scan beyond this share, from either end, are outliers.
constexpr double kOutliers = 0.01;
constexpr size_t kMostScans = 5;  // that are compared with a path

// `values` as a multiple of `shape`, by least squares over the entries of `values` that are not
// NaN.
struct Multiple {
  double factor = 0;             // 0 where the shape is 0
  double squares = 0, left = 0;  // of the values; after the multiple has been subtracted
};
Multiple AsMultiple(const Eigen::VectorXd& values, const Eigen::VectorXd& shape) {
  std::vector<Eigen::Index> seen;
  for (Eigen::Index k = 0; k < values.size(); ++k)
    if (!std::isnan(values[k])) seen.push_back(k);
  const Eigen::VectorXd own = values(seen), of_shape = shape(seen);
  const double size = of_shape.squaredNorm();
  const double factor = size > 0 ? own.dot(of_shape) / size : 0;
  return {factor, own.squaredNorm(), (own - factor * of_shape).squaredNorm()};
}

// Those that are compared: all frames of markers, a few of scans.
std::vector<int> ComparedFrames(const PredictedRecording& item) {
  if (!item.ShowsScans() || item.frames.size() <= kMostScans) return item.frames;
  std::vector<int> chosen;
  for (size_t k = 0; k < kMostScans; ++k)
    chosen.push_back(item.frames[k * (item.frames.size() - 1) / (kMostScans - 1)]);
  return chosen;
}

// The mean displacement of the markers that are seen in a frame and in the first one.
double MeanMotion(const Eigen::Matrix3Xd& first, const Eigen::Matrix3Xd& now,
                  const Eigen::Vector3d& direction) {
  double sum = 0, seen = 0;
  for (const double moved : (direction.transpose() * (now - first)).eval()) {
    if (std::isnan(moved)) continue;
    sum += moved;
    ++seen;
  }
  return seen > 0 ? sum / seen : std::numeric_limits<double>::quiet_NaN();
}

// The coordinates along `direction` of both ends of a scan.
Eigen::RowVector2d EndsOf(const ScannedPoints& scan, const Eigen::Vector3d& direction) {
  Eigen::VectorXd along = scan.cloud.points.transpose() * direction;
  std::sort(along.begin(), along.end());
  const Eigen::Index outliers =
      static_cast<Eigen::Index>(kOutliers * static_cast<double>(along.size()));
  return {along[outliers], along[along.size() - 1 - outliers]};
}

Eigen::MatrixXd ObjectMotion(const PredictedRecording& item, const std::vector<int>& frames,
                             const Eigen::Vector3d& direction) {
  const Eigen::Index count = static_cast<Eigen::Index>(frames.size());
  if (item.ShowsScans()) {
    Eigen::MatrixXd ends(count, 2);
    for (Eigen::Index k = 0; k < count; ++k)
      ends.row(k) = EndsOf(item.scans->At(frames[static_cast<size_t>(k)]), direction);
    return ends.rowwise() - Eigen::RowVector2d(ends.row(0));
  }
  const std::vector<Eigen::Matrix3Xd>& positions = item.recording.markers.positions;
  const Eigen::Matrix3Xd& first = positions[static_cast<size_t>(frames.front())];
  Eigen::MatrixXd mean(count, 1);
  for (Eigen::Index k = 0; k < count; ++k)
    mean(k, 0) = MeanMotion(first, positions[static_cast<size_t>(frames[static_cast<size_t>(k)])],
                            direction);
  return mean;
}

// The motion along the largest displacement of a grip; nothing where it rests or turns.
std::optional<DrivenMotion> MotionWith(const RecordedGrip& grip, const PredictedRecording& item,
                                       const std::vector<int>& frames) {
  if (grip.motion != GripMotion::kGiven || grip.rotations.cols() > 0 ||
      (!item.ShowsScans() && item.recording.markers.positions.empty()))
    return std::nullopt;
  const std::vector<double>& times = item.recording.times;
  const auto time = [&](int frame) { return times[static_cast<size_t>(frame)]; };
  Eigen::Matrix3Xd path(3, static_cast<Eigen::Index>(frames.size()));
  for (Eigen::Index k = 0; k < path.cols(); ++k)
    path.col(k) =
        MotionAt(grip, time(frames[static_cast<size_t>(k)]), time(frames.front())).translation();
  Eigen::Index farthest = 0;
  if (!(path.colwise().norm().maxCoeff(&farthest) > 0)) return std::nullopt;
  const Eigen::Vector3d direction = path.col(farthest).normalized();
  return DrivenMotion{path.transpose() * direction, ObjectMotion(item, frames, direction)};
}

}  // namespace

std::string MistakeInPath(const DrivenMotion& motion) {
  std::optional<double> found;
  for (const auto& moved : motion.object.colwise()) {
    const Multiple of_path = AsMultiple(moved, motion.path);
    if (!(of_path.left < kProportional * of_path.squares)) continue;
    const double ratio = of_path.factor;
    if (ratio >= kLeastRatio && ratio <= kLargestRatio) return "";  // something follows
    if (!found || std::abs(ratio) > std::abs(*found)) found = ratio;
  }
  if (!found) return "";
  if (std::abs(*found) < kLeastRatio || std::abs(*found) > kLargestRatio)
    return fmt::format(
        "the object moves {:.2g} times as far: is `length_unit` of the path that of its file?",
        std::abs(*found));
  return "the object moves in the opposite direction: do the signs of the path belong to the axes "
         "of the recording, and is it the path of the part that is named?";
}

std::string DoubtOfPaths(const PredictionStudy& study, const PredictedRecording& item) {
  constexpr size_t kFewestFrames = 3;
  if (study.scheme != TimeScheme::kQuasiStatic || item.frames.size() < kFewestFrames) return "";
  const std::vector<int> frames = ComparedFrames(item);
  for (const RecordedGrip& grip : item.recording.object.grips) {
    const std::optional<DrivenMotion> motion = MotionWith(grip, item, frames);
    const std::string mistake = motion ? MistakeInPath(*motion) : "";
    if (!mistake.empty())
      return fmt::format("{}: while \"{}\" moves along its path, {}", item.name, grip.region.name,
                         mistake);
  }
  return "";
}

std::string DoubtOfIncrements(const PredictedRecording& item) {
  constexpr size_t kFewestFrames = 4;
  // Points that follow the path leave less than the first share of their squares beside it; those
  // that follow its steps, less than the second share of what is left beside the path.
  constexpr double kFollows = 0.04, kBetter = 1.0 / 16;
  if (item.ShowsScans() || !HasTrackedPoints(item.recording) || item.frames.size() < kFewestFrames)
    return "";
  for (const RecordedGrip& grip : item.recording.object.grips) {
    const std::optional<DrivenMotion> motion = MotionWith(grip, item, item.frames);
    if (!motion) continue;
    const Eigen::VectorXd &path = motion->path, moved = motion->object.col(0);
    if (!moved.allFinite()) continue;
    Eigen::VectorXd steps = path;
    steps.tail(path.size() - 1) -= path.head(path.size() - 1);
    const Multiple of_path = AsMultiple(moved, path);
    if (of_path.left > kFollows * of_path.squares &&
        AsMultiple(moved, steps).left < kBetter * of_path.left)
      return fmt::format(
          "{}: the tracked points follow the steps of \"{}\" from frame to frame, not its path: "
          "are their displacements those since the frame before (incremental correlation)? They "
          "must be those since the reference state",
          item.name, grip.region.name);
  }
  return "";
}

}  // namespace lacuna
