// One moment of a recording: what the scanner saw, in SI and in the world frame.
#ifndef LACUNA_SCAN_FRAME_H_
#define LACUNA_SCAN_FRAME_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/point_cloud.h"

namespace lacuna {

// Where the points were seen from; it tells which side of a surface is outside.
struct Sensors {
  Eigen::Matrix3Xd positions;  // 3 × c, m; 3 × 0 where unknown
  Eigen::VectorXi seen_by;     // n, the sensor of each point; empty where unknown
};

struct Frame {
  int index = 0;    // within the recording, from 0
  double time = 0;  // s
  std::vector<std::string> files;

  PointCloud cloud;            // only finite points
  Eigen::VectorXi source_row;  // n, the row (vertex, marker) of each point in its file, from 0;
                               // empty where the points of several cameras are merged
  Eigen::Matrix3Xi triangles;  // 3 × m into `cloud`; 3 × 0 without connectivity
  Sensors sensors;
  Eigen::Index row_count = 0;      // points in the files
  Eigen::Index dropped_count = 0;  // of these, not finite (NaN) or outside the depth range
};

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_H_
