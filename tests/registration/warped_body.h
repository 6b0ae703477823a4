// Two independent scans of a soft body before and after a known motion.
#ifndef LACUNA_TESTS_REGISTRATION_WARPED_BODY_H_
#define LACUNA_TESTS_REGISTRATION_WARPED_BODY_H_

#include <Eigen/Core>
#include <cstdint>

#include "geometry/point_cloud.h"

namespace lacuna {

// `count` points with normals, spread evenly over a lumpy body about 0.2 m long, in random order.
PointCloud SampleBody(int count, uint64_t seed);

// The motion: a bend of 25° and a twist, neither of them a sum of Gaussians.
Eigen::Matrix3Xd Warp(const Eigen::Matrix3Xd& points);

struct ScanFaults {
  double noise = 0.0;             // m, of each coordinate
  double outliers = 0.0;          // of the count, evenly in a box around the body
  double missing_beyond_x = 1.0;  // m: points of the body at rest with a larger x are left out
};
PointCloud ScanOfWarpedBody(int count, uint64_t seed, const ScanFaults& faults = {});

double Rms(const Eigen::Matrix3Xd& vectors);

}  // namespace lacuna

#endif  // LACUNA_TESTS_REGISTRATION_WARPED_BODY_H_
