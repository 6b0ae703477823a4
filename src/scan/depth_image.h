// Depth images of a pinhole camera, their files, and the points that they measure.
//
// The camera looks along +z, with x to the right and y down. The point (x, y, z) of the camera
// frame appears at the pixel
//   u = fx·x/z + cx,  v = fy·y/z + cy
// (Hartley & Zisserman 2004, Eq. 6.3), whose centre has whole coordinates. Its depth is z, not its
// distance, in m; 0 means that nothing was measured.
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
  std::string name;  // name in messages
  Intrinsics intrinsics;
  Eigen::Isometry3d world_from_camera = Eigen::Isometry3d::Identity();
};

// Depths in m; the row is v, the column u.
using DepthImage = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Reads a 16-bit grey PNG; each count means `count_length` metres. The largest count, 65535, is
// that of saturated pixels and is read as 0. Throws InputError naming the file when it is absent,
// truncated or another kind of image.
DepthImage ReadDepthPng(const std::filesystem::path& file, double count_length);

// The width and the height of such a file, pixels. Throws InputError likewise.
Eigen::Vector2i DepthPngSize(const std::filesystem::path& file);

// Writes such a file atomically, with depths rounded to whole counts. All depths must fit in 16
// bits. Throws InputError when the file cannot be written.
void WriteDepthPng(const std::filesystem::path& file, const DepthImage& depth, double count_length);

// The points of the pixels with a depth in [min_depth, max_depth] (m), in the world frame and in
// the order of the pixels, row by row.
PointCloud BackProject(const DepthImage& depth, const Camera& camera, double min_depth,
                       double max_depth);

}  // namespace lacuna

#endif  // LACUNA_SCAN_DEPTH_IMAGE_H_
