#include "prediction/recording_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/residual_statistics.h"
#include "experiment/scan_frames.h"

namespace lacuna {
namespace {

// Markers rest where their distances stay within this many times those caused by noise, for at
// least kFewestAtRest frames.
constexpr double kRestThreshold = 2.5;
constexpr int kFewestAtRest = 8;

// Multiplies the rows of each marker (three of them) by the root of its mean weight in `frames`, so
// that all have the noise of a marker of weight 1.
void ScaleByWeights(const Markers& markers, const std::vector<int>& frames, Eigen::MatrixXd* rows) {
  if (markers.weights.empty() || frames.empty()) return;
  for (Eigen::Index m = 0; m < markers.places.cols(); ++m) {
    double sum = 0;
    for (const int frame : frames) sum += markers.weights[frame][m];
    rows->middleRows<3>(3 * m) *= std::sqrt(sum / static_cast<double>(frames.size()));
  }
}

}  // namespace

double EstimateRecordingNoise(const PredictedRecording& item, const std::vector<int>& frames) {
  if (item.scans != nullptr) return EstimateScanNoise(*item.scans, frames);
  Eigen::MatrixXd rows(item.recording.markers.places.size(),
                       static_cast<Eigen::Index>(frames.size()));
  for (size_t k = 0; k < frames.size(); ++k)
    rows.col(static_cast<Eigen::Index>(k)) = item.recording.markers.positions[frames[k]].reshaped();
  ScaleByWeights(item.recording.markers, frames, &rows);
  const double white = WhiteNoise(rows);
  if (!(white > 0)) return 0;
  Eigen::VectorXd times(static_cast<Eigen::Index>(frames.size()));
  for (size_t k = 0; k < frames.size(); ++k)
    times[static_cast<Eigen::Index>(k)] = item.recording.times[frames[k]];
  // The smallest deviation is used, because a body that is not quite at rest makes it larger.
  double least = std::numeric_limits<double>::infinity();
  for (const StaticSpan& rest :
       StaticSpans(times, rows, kRestThreshold * std::sqrt(6.0) * white, kFewestAtRest))
    if (!std::isnan(rest.deviation)) least = std::min(least, rest.deviation);
  return std::isfinite(least) ? least : white;
}

}  // namespace lacuna
