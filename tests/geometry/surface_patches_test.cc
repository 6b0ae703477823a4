#include "geometry/surface_patches.h"

#include <gtest/gtest.h>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

constexpr int kPatches = 100;

TriMesh Box(const std::array<int, 3>& cells) {
  return ExtractBoundary(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.03}, cells, 2)).surface;
}

TEST(SurfacePatches, HaveAboutEqualAreasAndCrossNoEdge) {
  const TriMesh surface = Box({6, 2, 2});
  const SurfacePatches patches = DivideSurface(surface, kPatches);
  ASSERT_EQ(patches.Count(), kPatches);
  const PointCloud points = EvaluateSamples(surface, SampleSurface(surface, 40000, 9));
  Eigen::VectorXd share = Eigen::VectorXd::Zero(kPatches);
  int across = 0;
  for (Eigen::Index j = 0; j < points.Size(); ++j) {
    const int patch = patches.PatchOf(points.points.col(j), points.normals.col(j));
    share[patch] += 1.0 / 40000;
    if (points.normals.col(j).dot(patches.normal.col(patch)) < 0.7) ++across;
  }
  // Cells of a Voronoi diagram after a few of Lloyd's iterations.
  EXPECT_GT(share.minCoeff(), 0.5 / kPatches);
  EXPECT_LT(share.maxCoeff(), 1.7 / kPatches);
  EXPECT_LT(across, 0.02 * 40000);
}

// Both sides of a sheet thinner than a patch is wide are told apart.
TEST(SurfacePatches, HaveOneSideOfASheet) {
  const TriMesh sheet =
      ExtractBoundary(BoxMesh({0, 0, 0}, {0.1, 0.1, 0.001}, {5, 5, 1}, 1)).surface;
  const SurfacePatches patches = DivideSurface(sheet, kPatches);
  const Eigen::Vector3d up = Eigen::Vector3d::UnitZ();
  for (const double x : {0.013, 0.05, 0.081}) {
    const int above = patches.PatchOf({x, 0.05, 0.001}, up);
    const int below = patches.PatchOf({x, 0.05, 0}, -up);
    EXPECT_GT(patches.normal(2, above), 0.9);
    EXPECT_LT(patches.normal(2, below), -0.9);
  }
}

TEST(SurfacePatches, AreTheSameEachTime) {
  const TriMesh surface = Box({6, 2, 2});
  EXPECT_EQ(DivideSurface(surface, kPatches).place, DivideSurface(surface, kPatches).place);
}

}  // namespace
}  // namespace lacuna
