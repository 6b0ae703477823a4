// Tracked points with known correspondences: row i is the same point in every frame.
#ifndef LACUNA_TESTS_REGISTRATION_TRACKED_FRAMES_H_
#define LACUNA_TESTS_REGISTRATION_TRACKED_FRAMES_H_

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "geometry/point_cloud.h"

namespace lacuna {

// The folder of rubber_strip's frames, points_00.csv …, among the published data; it may not exist.
std::filesystem::path RubberStripFrames();

// The points (3 × rows, m) of a file with a heading and lines that begin with x, y, z in mm; NaN
// where a point was not seen.
Eigen::Matrix3Xd ReadTrackedFrame(const std::filesystem::path& file);

// Two frames as unordered clouds, with the true correspondence.
struct TrackedPair {
  PointCloud source;  // m
  PointCloud target;
  std::vector<int> source_row;  // of each point
  std::vector<int> target_row;
  Eigen::Matrix3Xd held_out;         // 3 × h, m: in neither cloud, in the first frame
  Eigen::Matrix3Xd held_out_target;  // 3 × h, m: in the second
};

// Points k − 1, 2k − 1, … are held out for k = hold_out_every; none for 0.
TrackedPair MakeTrackedPair(const Eigen::Matrix3Xd& first, const Eigen::Matrix3Xd& second,
                            int hold_out_every);

struct CorrespondenceError {
  double rms = 0.0;  // m: of the displaced points from their true places
  int mistaken = 0;  // points that come nearest to another target point than their own
};

// `displaced` are the source's points of the pair (3 × M, m), in their order. Points that the
// second frame lacks do not count.
CorrespondenceError ErrorOf(const TrackedPair& pair, const Eigen::Matrix3Xd& displaced);

}  // namespace lacuna

#endif  // LACUNA_TESTS_REGISTRATION_TRACKED_FRAMES_H_
