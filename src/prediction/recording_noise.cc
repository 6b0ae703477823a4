#include "prediction/recording_noise.h"

#include "analysis/track_scatter.h"
#include "experiment/scan_frames.h"
#include "experiment/tracked_points.h"

namespace lacuna {

double EstimateRecordingNoise(const PredictedRecording& item, const std::vector<int>& frames) {
  if (item.ShowsScans()) return EstimateScanNoise(*item.scans, frames);
  Eigen::VectorXd times(static_cast<Eigen::Index>(frames.size()));
  for (size_t k = 0; k < frames.size(); ++k)
    times[static_cast<Eigen::Index>(k)] = item.recording.times[frames[k]];
  const double deviation =
      EstimateTrackNoise(times, WeightedTracks(item.recording.markers, frames)).deviation;
  return deviation > 0 ? deviation : 0;
}

}  // namespace lacuna
