// Preparation of the two clouds for registration: normalisation, and nested samples for a
// coarse-to-fine hierarchy.
#ifndef LACUNA_REGISTRATION_REGISTRATION_LEVEL_H_
#define LACUNA_REGISTRATION_REGISTRATION_LEVEL_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/point_cloud.h"
#include "registration/gaussian_sums.h"

namespace lacuna {

// Source and target in spatial order and in one common frame, (x − centre) / scale with the mean
// and the size of the source. A separate centre for a target that lacks a part would amount to a
// motion that did not take place.
struct NormalisedClouds {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  // m
  double scale = 1.0;                                // m
  Eigen::Matrix3Xd source;                           // 3 × M
  Eigen::Matrix3Xd source_normals;                   // 3 × M, 0 where unknown
  Eigen::Matrix3Xd target;                           // 3 × N
  std::vector<int> source_order;  // M: the index of each source point in the caller's cloud
  std::vector<int> target_order;  // N: the index of each target point in the caller's cloud
  double source_spacing = 0.0;    // distance between neighbours in the source
};

// Normalises the clouds. Normals are estimated if `source` has none. If all source points coincide,
// the scale is 0 and the rest is empty.
NormalisedClouds Normalise(const PointCloud& source, const PointCloud& target,
                           const GaussianKernels& kernels);

// For each level, from coarse to fine, every how many points of the larger cloud are used; the last
// entry is 1.
std::vector<int> LevelStrides(Eigen::Index larger_count);

// The stride for a cloud of `count` points on the level where the larger cloud uses `stride`: the
// largest power of two up to `stride` that gives about as many points.
int StrideFor(Eigen::Index count, Eigen::Index larger_count, int stride);

// One point from each run of `stride` ≥ 1 consecutive points: 3 × ⌈n/stride⌉ for 3 × n points.
Eigen::Matrix3Xd EveryNth(const Eigen::Matrix3Xd& points, int stride);

}  // namespace lacuna

#endif  // LACUNA_REGISTRATION_REGISTRATION_LEVEL_H_
