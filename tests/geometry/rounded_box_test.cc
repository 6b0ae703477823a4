#include "geometry/rounded_box.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/surface_check.h"

namespace lacuna {
namespace {

TEST(RoundedBox, BoundsTheVolumeOfABoxWithRoundedEdges) {
  const Eigen::Vector3d size(0.1, 0.04, 0.03);
  for (const double radius : {0.0, 0.005, 0.015}) {
    const TriMesh mesh = RoundedBox({0.5, -0.2, 0.1}, size, radius, 0.002);
    const SurfaceReport report = CheckSurface(mesh);
    EXPECT_TRUE(report.BoundsVolume()) << radius << ": " << DescribeFaults(report);
    // Minkowski sum of the inner box and a ball: V + A r + π (a + b + c) r² + 4/3 π r³.
    const Eigen::Array3d inner = size.array() - 2 * radius;
    const double expected =
        inner.prod() +
        2 * (inner[0] * inner[1] + inner[1] * inner[2] + inner[2] * inner[0]) * radius +
        std::numbers::pi * inner.sum() * radius * radius +
        4.0 / 3 * std::numbers::pi * std::pow(radius, 3);
    EXPECT_NEAR(report.volume, expected, 0.01 * expected) << radius;  // chords of the arcs
    const Eigen::AlignedBox3d box = BoundingBox(mesh.vertices);
    EXPECT_LT((box.sizes() - size).norm(), 1e-12);
  }
}

}  // namespace
}  // namespace lacuna
