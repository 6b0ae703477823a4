// Nested samples of the two clouds, from coarse to fine.
#ifndef LACUNA_REGISTRATION_REGISTRATION_LEVEL_H_
#define LACUNA_REGISTRATION_REGISTRATION_LEVEL_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// Source and target in one frame, (x − centre) / scale with the source's centre and size, in
// spatial order. One frame for both: a centre of its own for a target that lacks a part would be a
// motion that no point has made.
struct NormalisedClouds {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m
  double scale = 1.0;                                // m
  Eigen::Matrix3Xd source;                           // 3 × M
  Eigen::Matrix3Xd source_normals;                   // 3 × M, 0 where unknown
  Eigen::Matrix3Xd target;                           // 3 × N
  std::vector<int> source_order;  // the place in the caller's cloud of each source point
  std::vector<int> target_order;
  double source_spacing = 0.0;  // between neighbours
};

// Normals are estimated where `source` has none. A scale of 0 means that the source has no extent.
NormalisedClouds Normalise(const PointCloud& source, const PointCloud& target,
                           const GaussianKernels& kernels);

// Every how many points of the larger cloud are taken per level; the last is 1.
std::vector<int> LevelStrides(Eigen::Index larger_count);

// The largest power of two up to `stride` with which `count` points still give about as many as
// the larger cloud gives with `stride`.
int StrideFor(Eigen::Index count, Eigen::Index larger_count, int stride);

// One point of each run of `stride`.
Eigen::Matrix3Xd EveryNth(const Eigen::Matrix3Xd& points, int stride);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_REGISTRATION_LEVEL_H_
