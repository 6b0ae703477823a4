// The scanned points of a recording as a prediction is compared with them: cleaned as a
// reconstruction does, with normals, thinned, nothing smoothed and nothing registered.
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
  bool points_out = true;     // the normals' sign is known; false: only their line
  double noise = 0;           // m, about the points' own surface (EstimateNoise)
  Eigen::Index in_files = 0;  // finite points before the filter and the thinning
};

// Reads a frame when it is first asked for and keeps it. Copies of a study share it; several
// threads may ask at once.
class ScanFrames {
 public:
  ScanFrames(Recording recording, const ScanSettings& settings);

  // Throws InputError naming the frame.
  const ScannedPoints& At(int frame) const;
  const Recording& recording() const { return recording_; }

 private:
  Recording recording_;
  ScanSettings settings_;
  mutable std::mutex mutex_;
  mutable std::map<int, ScannedPoints> frames_;
};

// How far the surface moves along its normal from one scan to the other: the 95th percentile over
// the points of `to` of the distance from the plane through their nearest point of `from`, m.
double LargestMove(const ScannedPoints& from, const ScannedPoints& to);

// The noise of a scanned point along the normal, m: the median over at most ten of the frames,
// evenly chosen. 0 without frames.
double EstimateScanNoise(const ScanFrames& scans, const std::vector<int>& frames);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_SCAN_FRAMES_H_
