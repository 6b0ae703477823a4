#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "geometry/nearest.h"
#include "geometry/surface_check.h"
#include "support/shapes.h"
#include "surface/repair.h"

namespace lacuna {
namespace {

TEST(RemeshIsotropic, MakesUniformTrianglesOnTheSameSurface) {
  const TriMesh body = OrganicSurface(5);
  const TriMesh remeshed = RemeshIsotropic(body, 0.15);
  const SurfaceReport report = CheckSurface(remeshed);
  EXPECT_TRUE(report.BoundsVolume()) << DescribeFaults(report);
  EXPECT_NEAR(report.mean_edge, 0.15, 0.02);
  EXPECT_GT(report.min_angle, 0.5);
  // New vertices lie on the old triangles, to rounding; the volume changes by the chords.
  EXPECT_LT(SurfaceSearch(body).Nearest(remeshed.vertices).distance.maxCoeff(), 1e-12);
  EXPECT_NEAR(report.volume, EnclosedVolume(body), 0.01 * EnclosedVolume(body));
}

TEST(RemeshIsotropic, KeepsTheRimOfAnOpenSheet) {
  const TriMesh sheet = FlatSheet(0.3, 0.1, 30, 10);
  const SurfaceReport report = CheckSurface(RemeshIsotropic(sheet, 0.02));
  EXPECT_EQ(report.boundary_loops.size(), 1u);
  EXPECT_TRUE(report.IsManifold() && report.IsOriented() && report.IsFreeOfIntersections());
  EXPECT_NEAR(report.area, 0.03, 0.02 * 0.03);  // corners may be cut by half an edge
}

TEST(RemeshIsotropic, IsReproducibleBitByBit) {
  const TriMesh body = OrganicSurface(4);
  const TriMesh first = RemeshIsotropic(body, 0.1);
  const TriMesh second = RemeshIsotropic(body, 0.1);
  EXPECT_EQ(first.vertices, second.vertices);
  EXPECT_EQ(first.triangles, second.triangles);
}

TEST(RemeshIsotropic, RefusesANonManifoldSurface) {
  const TriMesh book = MeshOf({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
                              {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
  EXPECT_THROW(RemeshIsotropic(book, 0.1), InputError);
  EXPECT_THROW(RemeshIsotropic({}, 0.1), InputError);
}

}  // namespace
}  // namespace lacuna
