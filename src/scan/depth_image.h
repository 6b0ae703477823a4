// Depth images of a pinhole camera, their files and the points they stand for.
//
// The camera looks along +z with x to the right and y down; pixel centres have whole coordinates:
//   u = fx·x/z + cx,  v = fy·y/z + cy.
// A depth is the z of the point (not its distance), m; 0 means "nothing measured".
#ifndef LACUNA_SCAN_DEPTH_IMAGE_H_
#define LACUNA_SCAN_DEPTH_IMAGE_H_

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <filesystem>
#include <string>

#include "geometry/point_cloud.h"

namespace lacuna {

struct Intrinsics {
  double fx = 0, fy = 0;  // focal lengths, pixels
  double cx = 0, cy = 0;  // principal point, pixels
};

struct Camera {
  std::string name;
  Intrinsics intrinsics;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
};

using DepthImage = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // v, u

// Reads a 16-bit grey PNG; each count stands for `count_length` metres. Throws InputError naming
// the file when it is absent, truncated or of another kind.
DepthImage ReadDepthPng(const std::filesystem::path& file, double count_length);

// Depths are rounded to whole counts; those that do not fit in 16 bits are a mistake of ours.
void WriteDepthPng(const std::filesystem::path& file, const DepthImage& depth, double count_length);

// The pixels with a depth in [min_depth, max_depth] as points of the world frame, row by row.
PointCloud BackProject(const DepthImage& depth, const Camera& camera, double min_depth,
                       double max_depth);

}  // namespace lacuna

#endif  // LACUNA_SCAN_DEPTH_IMAGE_H_
