// Stage 1 of the paper: removes the outliers of a frame, evens out its density and gives it
// normals.
//
// Outliers (Rusu et al. 2008, computed by PCL's StatisticalOutlierRemoval): with d_i the mean
// distance of point i to its k nearest neighbours, the point is removed when
//   d_i > mean(d) + a·std(d).
// Then the points in each cube of a grid are replaced by their mean (PCL's VoxelGrid), and normals
// are those of the plane fitted to the nearest points.
#ifndef LACUNA_SCAN_FILTER_H_
#define LACUNA_SCAN_FILTER_H_

#include "geometry/point_cloud.h"
#include "scan/frame.h"
#include "scan/normal_orientation.h"

namespace lacuna {

struct FilterOptions {
  int outlier_neighbours = 16;      // k; 0: none are removed. Larger: finds clumps of outliers too
  double outlier_deviations = 2.0;  // a; larger: removes fewer points
  double voxel_size = 0;            // m; 0: no grid. Larger: fewer points, less noise, less detail
  int normal_neighbours = 20;       // larger: smoother normals, but edges are more rounded
  bool renew_normals = false;       // estimate normals even if the file has them
};

struct FilterResult {
  PointCloud cloud;  // remaining points with unit normals
  Sensors sensors;   // sensors of the remaining points
  Eigen::Index input_count = 0;
  Eigen::Index outlier_count = 0;     // removed as outliers
  Eigen::Index merged_count = 0;      // points fewer after each cube was replaced by its mean
  Eigen::Index degenerate_count = 0;  // dropped because they have no normal
  Orientation orientation;
};

// Filters a cloud of finite points (m). PCL computes in single precision; coordinates are taken
// relative to the centre of the cloud, which keeps them accurate to 1e-7 of its size. Throws
// InputError when fewer than four points remain or the voxels are too many to be numbered.
FilterResult FilterCloud(const PointCloud& cloud, const Sensors& sensors,
                         const FilterOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SCAN_FILTER_H_
