// A frame: what the scanner saw at one instant of a recording, in SI units and in the world frame.
#ifndef LACUNA_SCAN_FRAME_H_
#define LACUNA_SCAN_FRAME_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "geometry/point_cloud.h"

namespace lacuna {

// The positions from which the points were observed, which determine the outer side of a surface.
struct Sensors {
  Eigen::Matrix3Xd positions;  // 3 × c, m; 3 × 0 if unknown
  Eigen::VectorXi seen_by;     // n, the sensor that saw each point, from 0; empty if unknown
};

struct Frame {
  int index = 0;                   // number in the recording, from 0
  double time = 0;                 // s
  std::vector<std::string> files;  // files from which it was read

  PointCloud cloud;            // n usable points
  Eigen::VectorXi source_row;  // n, the row (vertex, marker) of each point in its file, from 0;
                               // empty for depth images, which have no rows
  // n, the standard deviation that the program of image correlation expects of each point, in any
  // unit: only ratios count; empty if it gives none.
  Eigen::VectorXd sigma;
  Eigen::Matrix3Xi triangles;  // 3 × m, points of `cloud`; 3 × 0 without connectivity
  Sensors sensors;
  Eigen::Index row_count = 0;       // points in the files
  Eigen::Index dropped_count = 0;   // points not used: not finite, above 1e9 m or, in depth
                                    // images, outside the depth range; and those below; not
                                    // counted are vertices of a mesh that were merged
  Eigen::Index repeated_count = 0;  // of these, because they repeat exactly (frame_points.h)
  Eigen::Index cropped_count = 0;   // because they lie outside the crop
  Eigen::Index separate_count = 0;  // because they do not belong to the largest component
  std::vector<std::string> notes;   // doubts about the files, which they name
};

}  // namespace lacuna

#endif  // LACUNA_SCAN_FRAME_H_
