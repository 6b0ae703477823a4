#include "meshing/tet_quality.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/box_mesh.h"

namespace lacuna {
namespace {

constexpr double kRightAngle = std::numbers::pi / 2;

TetMesh OneTet(const Eigen::Matrix<double, 3, 4>& corners) {
  return {corners, Eigen::Vector4i(0, 1, 2, 3)};
}

TEST(MeasureTets, GivesTheKnownValuesOfARegularTetrahedron) {
  Eigen::Matrix<double, 3, 4> corners;
  corners << 1, 1, -1, -1, 1, -1, -1, 1, 1, -1, 1, -1;
  const TetQuality quality = MeasureTets(OneTet(corners));
  // Of a regular tetrahedron with edges 2√2: textbook values, to rounding.
  EXPECT_NEAR(quality.total_volume, 8.0 / 3, 1e-14);
  EXPECT_NEAR(quality.edge_length.mean, 2 * std::numbers::sqrt2, 1e-14);
  EXPECT_NEAR(quality.radius_edge_ratio.max, std::sqrt(6.0) / 4, 1e-14);
  EXPECT_NEAR(quality.aspect_ratio.max, 1, 1e-14);
  EXPECT_NEAR(quality.min_dihedral_angle, std::acos(1.0 / 3), 1e-14);
  EXPECT_NEAR(quality.max_dihedral_angle, std::acos(1.0 / 3), 1e-14);
  EXPECT_EQ(quality.inverted, 0);
}

TEST(MeasureTets, CountsCurvedEdgesInTheTotalVolume) {
  Eigen::Matrix<double, 3, 4> corners;
  corners << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  TetMesh mesh = ToQuadratic(OneTet(corners));
  EXPECT_NEAR(MeasureTets(mesh).total_volume, 1.0 / 6, 1e-15);
  // tet_mesh_test.cc has the formula.
  mesh.nodes.col(mesh.tets(5, 0)) += Eigen::Vector3d(0.1, 0.1, 0);
  EXPECT_NEAR(MeasureTets(mesh).total_volume, 0.2, 1e-15);
}

TEST(MeasureTets, GivesTheKnownValuesOfTheCornerOfACube) {
  Eigen::Matrix<double, 3, 4> corners;
  corners << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  const TetQuality quality = MeasureTets(OneTet(corners));
  EXPECT_NEAR(quality.radius_edge_ratio.max, std::sqrt(3.0) / 2, 1e-14);
  EXPECT_NEAR(quality.max_dihedral_angle, kRightAngle, 1e-14);
  EXPECT_NEAR(quality.min_dihedral_angle, std::atan(std::numbers::sqrt2), 1e-14);
  // Inradius 1/(3 + √3).
  EXPECT_NEAR(quality.aspect_ratio.max,
              std::numbers::sqrt2 * (3 + std::sqrt(3.0)) / std::sqrt(24.0), 1e-14);
}

TEST(MeasureTets, ShapeDoesNotDependOnSize) {
  TetMesh mesh = BoxMesh({0, 0, 0}, {1, 2, 3}, {2, 2, 2});
  const TetQuality metres = MeasureTets(mesh);
  mesh.nodes *= 1e-6;
  const TetQuality micrometres = MeasureTets(mesh);
  EXPECT_NEAR(metres.radius_edge_ratio.mean, micrometres.radius_edge_ratio.mean, 1e-12);
  EXPECT_NEAR(metres.min_dihedral_angle, micrometres.min_dihedral_angle, 1e-12);
}

TEST(MeasureTets, CountsTetrahedraThatAreInvertedOrAboveTheBounds) {
  TetMesh mesh = BoxMesh({0, 0, 0}, {1, 1, 1}, {1, 1, 1});
  // Six congruent tetrahedra of volume 1/6 around the diagonal, with the cube's circumsphere.
  EXPECT_EQ(MeasureTets(mesh, 0.86, 0.16).above_ratio, 6);
  EXPECT_EQ(MeasureTets(mesh, 0.87, 0.17).above_ratio, 0);
  EXPECT_EQ(MeasureTets(mesh, 0.86, 0.16).above_volume, 6);
  EXPECT_EQ(MeasureTets(mesh, 0.87, 0.17).above_volume, 0);
  std::swap(mesh.tets(0, 2), mesh.tets(1, 2));
  EXPECT_EQ(MeasureTets(mesh).inverted, 1);
}

TEST(MeasureTets, OfAnEmptyMeshIsEmpty) { EXPECT_EQ(MeasureTets({}).tets, 0); }

}  // namespace
}  // namespace lacuna
