// The scanned points of a recording in the form in which predictions are compared with them:
// cleaned as for a reconstruction, with normals, and thinned. They are neither smoothed nor
// registered.
#ifndef LACUNA_EXPERIMENT_SCAN_FRAMES_H_
#define LACUNA_EXPERIMENT_SCAN_FRAMES_H_

#include <Eigen/Core>
#include <map>
#include <mutex>
#include <vector>

#include "experiment/scan_settings.h"
#include "geometry/point_cloud.h"
#include "scan/recording.h"

namespace lacuna {

struct ScannedPoints {
  PointCloud cloud;           // with unit normals
  bool points_out = true;     // whether the sign of the normals is known
  double noise = 0;           // m, σ about the points' own surface (EstimateNoise)
  Eigen::Index in_files = 0;  // finite points before filtering and thinning
};

// Reads each frame when it is first needed, and keeps it. Copies of a study share this object;
// several threads may use it at once.
class ScanFrames {
 public:
  ScanFrames(Recording recording, const ScanSettings& settings);

  // Throws InputError, which names the frame.
  const ScannedPoints& At(int frame) const;
  const Recording& recording() const { return recording_; }

 private:
  Recording recording_;
  ScanSettings settings_;
  mutable std::mutex mutex_;
  mutable std::map<int, ScannedPoints> frames_;
};

// The motion of the surface along its normal from one scan to the other, m: the 95th percentile
// over the points of `to` of their distance from the tangent plane at the nearest point of `from`.
double LargestMove(const ScannedPoints& from, const ScannedPoints& to);

// The noise of a scanned point along the normal, m: the median over at most ten evenly chosen
// frames; 0 without frames.
double EstimateScanNoise(const ScanFrames& scans, const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCAN_FRAMES_H_
