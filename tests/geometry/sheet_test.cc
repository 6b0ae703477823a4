#include "geometry/sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.h"
#include "geometry/surface_check.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

// Half a cylinder of the given radius and length 1, normals outward.
TriMesh HalfCylinder(double radius, int columns) {
  TriMesh sheet = FlatSheet(1, std::numbers::pi, 10, columns);
  for (auto v : sheet.vertices.colwise()) {
    const double angle = v.y();
    v << v.x(), -radius * std::cos(angle), radius * std::sin(angle);
  }
  return sheet;
}

std::string FailureOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(ThickenToTets, PutsTheMaterialOnTheRequestedSide) {
  const TriMesh sheet = FlatSheet(1, 1, 2, 2);
  const auto heights = [&](SheetPosition position) {
    const Eigen::VectorXd z = ThickenToTets(sheet, 0.1, 1, position).nodes.row(2);
    return Eigen::Vector2d(z.minCoeff(), z.maxCoeff());
  };
  EXPECT_EQ(heights(SheetPosition::kMiddle), Eigen::Vector2d(-0.05, 0.05));
  EXPECT_EQ(heights(SheetPosition::kTop), Eigen::Vector2d(-0.1, 0));
  EXPECT_EQ(heights(SheetPosition::kBottom), Eigen::Vector2d(0, 0.1));
}

TEST(ThickenToTets, FillsTheSheetWithConformingTets) {
  const TetMesh mesh = ThickenToTets(FlatSheet(0.3, 0.1, 12, 4), 0.002, 3);
  EXPECT_EQ(mesh.TetCount(), 3 * 3 * 2 * 12 * 4);
  const Eigen::VectorXd volumes = TetVolumes(mesh);
  EXPECT_GT(volumes.minCoeff(), 0);
  EXPECT_NEAR(volumes.sum(), 0.3 * 0.1 * 0.002, 1e-17);
  // If the diagonals of neighbouring prisms disagreed, cracks would add faces to the boundary.
  const SurfaceReport report = CheckSurface(ExtractBoundary(mesh).surface);
  EXPECT_TRUE(report.BoundsVolume()) << DescribeFaults(report);
  EXPECT_EQ(report.euler_characteristic, 2);
  EXPECT_EQ(report.triangles, 2 * (2 * 12 * 4) + 2 * 3 * 2 * (12 + 4));
}

TEST(ThickenToTets, StacksItsNodesByLevels) {
  const TriMesh sheet = HalfCylinder(0.5, 20);
  const TetMesh mesh = ThickenToTets(sheet, 0.04, 2);
  const Eigen::Index n = sheet.vertices.cols();
  ASSERT_EQ(mesh.NodeCount(), 3 * n);
  EXPECT_LT((mesh.nodes.middleCols(n, n) - sheet.vertices).norm(), 1e-15);
  for (Eigen::Index v = 0; v < n; ++v) {
    const double below = mesh.nodes.col(v).tail<2>().norm();
    const double above = mesh.nodes.col(v + 2 * n).tail<2>().norm();
    // Normals of the polygonal cylinder's rim lean by up to half a facet, 0.08 rad.
    EXPECT_NEAR(above - below, 0.04, 0.04 * 0.08 * 0.08);
  }
}

TEST(ThickenToTets, RefusesInvalidSheetsWithTheReason) {
  EXPECT_THAT(FailureOf([] { ThickenToTets(Icosphere(1, 1), 0.1, 1); }), HasSubstr("closed"));

  TriMesh twisted = FlatSheet(1, 1, 2, 2);
  std::swap(twisted.triangles(0, 0), twisted.triangles(1, 0));
  EXPECT_THAT(FailureOf([&] { ThickenToTets(twisted, 0.1, 1); }),
              HasSubstr("opposite orientations"));

  const TriMesh book = MeshOf({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}},
                              {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
  EXPECT_THAT(FailureOf([&] { ThickenToTets(book, 0.1, 1); }),
              HasSubstr("more than two triangles"));
}

TEST(ThickenToTets, RefusesAThicknessBeyondTheCurvature) {
  EXPECT_EQ(FailureOf([] { ThickenToTets(HalfCylinder(0.5, 20), 0.2, 1); }), "");
  EXPECT_THAT(FailureOf([] { ThickenToTets(HalfCylinder(0.5, 20), 1.2, 1); }),
              HasSubstr("bends too sharply"));
}

}  // namespace
}  // namespace lacuna
