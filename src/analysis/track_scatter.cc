#include "analysis/track_scatter.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <vector>

namespace lacuna {
namespace {

// Markers rest where their distances stay within this many times those caused by noise, for at
// least kFewestAtRest frames.
constexpr double kRestThreshold = 2.5;
constexpr int kFewestAtRest = 8;
constexpr double kOutlierDeviations = 5;
constexpr double kUpperQuartile = 1.1503;  // Φ⁻¹(7/8): of |x|, x normal with σ = 1
constexpr int kReach = 2;                  // frames before and after that a place is compared with
constexpr double kUnevenTimes = 0.05;  // largest difference of a step from the mean of its window
constexpr Eigen::Index kFewestPoints = 5;  // of a frame, so that one is less than a quarter

// White noise of deviation σ differs by this many σ from the cubic through its neighbours in time.
const double kFromCubic = std::sqrt(70.0) / 6;

// Whether the frames that frame f is compared with are equally spaced in time.
bool IsEvenlySpaced(const Eigen::VectorXd& times, Eigen::Index f) {
  const double mean = (times[f + kReach] - times[f - kReach]) / (2 * kReach);
  for (Eigen::Index g = f - kReach; g < f + kReach; ++g)
    if (!(std::abs(times[g + 1] - times[g] - mean) <= kUnevenTimes * mean)) return false;
  return true;
}

// The absolute difference of each coordinate from the cubic through its neighbours in time, in
// units in which white noise of deviation σ has the deviation σ. NaN where it is not known.
Eigen::MatrixXd DistancesFromCubic(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions) {
  Eigen::MatrixXd distances =
      Eigen::MatrixXd::Constant(positions.rows(), positions.cols(), kUnknown);
  for (Eigen::Index f = kReach; f + kReach < positions.cols(); ++f) {
    if (!IsEvenlySpaced(times, f)) continue;
    const Eigen::VectorXd expected = (4 * (positions.col(f - 1) + positions.col(f + 1)) -
                                      positions.col(f - 2) - positions.col(f + 2)) /
                                     6;
    distances.col(f) = (positions.col(f) - expected).cwiseAbs() / kFromCubic;
  }
  return distances;
}

// The deviation that three quarters of the coordinates of a frame show; 0 where none is known.
double DeviationInFrame(const Eigen::VectorXd& distances) {
  std::vector<double> known;
  for (const double distance : distances)
    if (!std::isnan(distance)) known.push_back(distance);
  if (known.empty()) return 0;
  const auto high = known.begin() + static_cast<std::ptrdiff_t>(3 * known.size() / 4);
  std::nth_element(known.begin(), high, known.end());
  return *high / kUpperQuartile;
}

}  // namespace

TrackNoise EstimateTrackNoise(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions) {
  TrackNoise noise;
  const double white = WhiteNoise(positions);
  noise.deviation = white;
  if (!(white > 0)) return noise;
  for (const StaticSpan& rest :
       StaticSpans(times, positions, kRestThreshold * std::sqrt(6.0) * white, kFewestAtRest))
    if (!std::isnan(rest.deviation) && !(noise.rest.deviation <= rest.deviation)) noise.rest = rest;
  noise.is_at_rest = !std::isnan(noise.rest.deviation);
  if (noise.is_at_rest) noise.deviation = noise.rest.deviation;
  return noise;
}

TrackOutliers FindTrackOutliers(const Eigen::VectorXd& times, const Eigen::MatrixXd& positions,
                                const Eigen::VectorXd& deviations) {
  CHECK_EQ(positions.rows(), 3 * deviations.size());
  CHECK_EQ(positions.cols(), times.size());
  const Eigen::MatrixXd distances = DistancesFromCubic(times, positions);
  const Eigen::Index points = positions.rows() / 3, frames = positions.cols();
  // The largest distance of a coordinate of each point in each frame; NaN where it is not known.
  Eigen::MatrixXd largest(points, frames);
  for (Eigen::Index f = 0; f < frames; ++f)
    for (Eigen::Index p = 0; p < points; ++p) {
      const auto of_point = distances.col(f).segment<3>(3 * p);
      largest(p, f) = of_point.hasNaN() ? kUnknown : of_point.maxCoeff();
    }
  TrackOutliers outliers;
  double judged = 0, found = 0;
  for (Eigen::Index f = 0; f < frames; ++f) {
    if ((largest.col(f).array() >= 0).count() < kFewestPoints) continue;
    const double in_all = DeviationInFrame(distances.col(f));
    const Eigen::Index begin = std::max<Eigen::Index>(0, f - kReach);
    const Eigen::Index end = std::min(frames, f + kReach + 1);
    int in_frame = 0;
    for (Eigen::Index p = 0; p < points; ++p) {
      const double distance = largest(p, f);
      if (std::isnan(distance)) continue;
      ++judged;
      if (distance <= kOutlierDeviations * std::max(deviations[p], in_all)) continue;
      bool is_largest = true;
      for (Eigen::Index g = begin; g < end; ++g) is_largest &= !(largest(p, g) > distance);
      if (!is_largest) continue;
      ++in_frame;
      outliers.farthest = std::max(outliers.farthest, kFromCubic * distance);
    }
    found += in_frame;
    if (in_frame <= outliers.in_worst_frame) continue;
    outliers.in_worst_frame = in_frame;
    outliers.worst_frame = static_cast<int>(f);
  }
  if (judged > 0) outliers.share = found / judged;
  return outliers;
}

}  // namespace lacuna
