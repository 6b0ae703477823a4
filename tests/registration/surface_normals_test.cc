#include "registration/surface_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "registration/registration_level.h"
#include "registration/warped_body.h"

namespace lacuna {
namespace {

TEST(SurfaceNormalsTest, AgreeWithThoseOfTheBody) {
  PointCloud body = SampleBody(4000, 1);
  const Eigen::Matrix3Xd truth = body.normals;
  body.normals.resize(3, 0);
  const NormalisedClouds clouds = Normalise(body, body, BestKernels());
  std::vector<double> sine(4000);
  for (int i = 0; i < 4000; ++i) {
    const double cosine = clouds.source_normals.col(i).dot(truth.col(clouds.source_order[i]));
    sine[i] = std::sqrt(std::max(0.0, 1.0 - cosine * cosine));
  }
  std::sort(sine.begin(), sine.end());
  // Over the neighbourhood's radius of about 3 mm the normal rotates by 0.15 rad at a radius of
  // curvature of 2 cm; averaging cancels most of that.
  EXPECT_LT(sine[2000], 0.03);
  EXPECT_LT(sine[3960], 0.2);
}

TEST(SurfaceNormalsTest, SpacingIsTheSquareRootOfTheAreaPerPoint) {
  Eigen::Matrix3Xf square(3, 4096);
  for (int i = 0; i < 4096; ++i) square.col(i) << (i % 64) / 64.f, (i / 64) / 64.f, 0.f;
  Eigen::Matrix3Xf sorted(3, 4096);
  const std::vector<int> order = SpatialOrder(square);
  for (int i = 0; i < 4096; ++i) sorted.col(i) = square.col(order[i]);
  // Blocks of 4 × 4 points of a lattice span 15/16 of the variance of their square.
  EXPECT_NEAR(SurfaceSpacing(BlockTree(sorted)), 1.0 / 64, 0.05 / 64);
}

}  // namespace
}  // namespace lacuna
