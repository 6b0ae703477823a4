#include "experiment/scan_frames.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "core/error.h"
#include "core/median.h"
#include "core/random_bits.h"
#include "experiment/frame_states.h"
#include "geometry/nearest.h"

namespace lacuna {
namespace {

// A random subset of `count` points, in their original order.
PointCloud Thinned(const PointCloud& cloud, int count) {
  if (cloud.Size() <= count) return cloud;
  std::vector<Eigen::Index> order(static_cast<size_t>(cloud.Size()));
  std::iota(order.begin(), order.end(), 0);
  std::nth_element(
      order.begin(), order.begin() + count, order.end(), [](Eigen::Index a, Eigen::Index b) {
        const auto bits = [](Eigen::Index i) { return RandomBits({static_cast<uint64_t>(i)}); };
        return std::pair(bits(a), a) < std::pair(bits(b), b);
      });
  order.resize(static_cast<size_t>(count));
  std::sort(order.begin(), order.end());
  return {cloud.points(Eigen::all, order), cloud.normals(Eigen::all, order)};
}

ScannedPoints ReadPoints(const Recording& recording, int number, const ScanSettings& settings) {
  const Frame frame = LoadFrame(recording, number);
  ScannedPoints scanned;
  scanned.in_files = frame.cloud.Size();
  if (frame.triangles.cols() > 0) {
    scanned.cloud = {frame.cloud.points, VertexNormals({frame.cloud.points, frame.triangles})};
  } else {
    const FilterResult filtered =
        NamingWhere(fmt::format("{}: frame {}", recording.file.string(), number),
                    [&] { return FilterCloud(frame.cloud, frame.sensors, settings.filter); });
    scanned.cloud = filtered.cloud;
    scanned.points_out = filtered.orientation.doubtful_component_count == 0;
  }
  scanned.noise = EstimateNoise(scanned.cloud.points);
  scanned.cloud = Thinned(scanned.cloud, settings.points);
  return scanned;
}

}  // namespace

ScanFrames::ScanFrames(Recording recording, const ScanSettings& settings)
    : recording_(std::move(recording)), settings_(settings) {}

const ScannedPoints& ScanFrames::At(int frame) const {
  const std::scoped_lock lock(mutex_);
  const auto known = frames_.find(frame);
  if (known != frames_.end()) return known->second;
  return frames_.emplace(frame, ReadPoints(recording_, frame, settings_)).first->second;
}

double LargestMove(const ScannedPoints& from, const ScannedPoints& to) {
  const PointHits near = PointSearch(from.cloud.points).Nearest(to.cloud.points);
  std::vector<double> moves(static_cast<size_t>(to.cloud.Size()));
  for (Eigen::Index j = 0; j < to.cloud.Size(); ++j) {
    const int i = near.index(0, j);
    moves[static_cast<size_t>(j)] =
        std::abs(from.cloud.normals.col(i).dot(to.cloud.points.col(j) - from.cloud.points.col(i)));
  }
  const auto high = moves.begin() + static_cast<std::ptrdiff_t>(0.95 * moves.size());
  std::nth_element(moves.begin(), high, moves.end());
  return *high;
}

double EstimateScanNoise(const ScanFrames& scans, const std::vector<int>& frames) {
  constexpr size_t kMost = 10;
  if (frames.empty()) return 0;
  std::vector<double> noises;
  const size_t count = std::min(kMost, frames.size());
  for (size_t k = 0; k < count; ++k)
    noises.push_back(scans.At(frames[k * frames.size() / count]).noise);
  return Median(std::move(noises));
}

}  // namespace lacuna
