// Stage 1 of the paper: takes outliers out of a frame, evens out its density and gives it normals.
//
//   d_i = mean distance of point i to its k nearest; removed when d_i > mean(d) + a·std(d)
// (Rusu et al. 2008, as PCL's StatisticalOutlierRemoval computes it), then one point, the mean, per
// cube of a grid (PCL's VoxelGrid), then normals from the plane through the nearest points.
#ifndef LACUNA_SCAN_FILTER_H_
#define LACUNA_SCAN_FILTER_H_

#include "geometry/point_cloud.h"
#include "scan/frame.h"
#include "scan/normal_orientation.h"

namespace lacuna {

struct FilterOptions {
  int outlier_neighbours = 16;      // k; 0: no removal. Larger: clumps of outliers are found too
  double outlier_deviations = 2.0;  // a; larger: fewer points are removed
  double voxel_size = 0;            // m; 0: no grid. Larger: fewer points, less noise, less detail
  int normal_neighbours = 20;       // larger: smoother normals, edges rounded more
  bool renew_normals = false;       // estimate normals also where the file gives them
};

struct FilterResult {
  PointCloud cloud;                   // with normals
  Sensors sensors;                    // of its points
  Eigen::Index input_count = 0;       // points that came in
  Eigen::Index outlier_count = 0;     // of these, removed as outliers
  Eigen::Index merged_count = 0;      // of the rest, gone into the mean of their cube
  Eigen::Index degenerate_count = 0;  // of the rest, dropped for want of a normal
  Orientation orientation;
};

// All points must be finite. Coordinates enter PCL's single precision about their centre, so that
// they are exact to 1e-7 of the cloud's size. Throws InputError when fewer than four points remain
// or the voxel is too small for the cloud's extent.
FilterResult FilterCloud(const PointCloud& cloud, const Sensors& sensors,
                         const FilterOptions& options);

}  // namespace lacuna

#endif  // LACUNA_SCAN_FILTER_H_
