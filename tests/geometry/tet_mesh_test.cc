#include "geometry/tet_mesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "geometry/surface_check.h"
#include "support/box_mesh.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;

constexpr double kBoxVolume = 0.2 * 0.03 * 0.04;
TetMesh Box() { return BoxMesh(Vector3d::Zero(), {0.2, 0.03, 0.04}, {5, 2, 3}); }

TEST(TetMesh, VolumesArePositiveAndFillTheBox) {
  const Eigen::VectorXd volumes = TetVolumes(Box());
  EXPECT_GT(volumes.minCoeff(), 0);
  EXPECT_NEAR(volumes.sum(), kBoxVolume, 1e-14 * kBoxVolume);
}

TEST(TetMesh, FindsATetrahedronWithoutVolume) {
  TetMesh box = Box();
  EXPECT_EQ(FindFlatTet(box), -1);
  // The last corner of tetrahedron 7 moves into the plane of the others.
  const auto tet = box.tets.col(7);
  box.nodes.col(tet[3]) =
      (box.nodes.col(tet[0]) + box.nodes.col(tet[1]) + box.nodes.col(tet[2])) / 3;
  const Eigen::Index flat = FindFlatTet(box);
  ASSERT_GE(flat, 0);
  EXPECT_LE(flat, 7) << "others at that corner may have become flat too";
}

// Coordinates far from the origin are rounded, so that the volume of a flat tetrahedron need not be
// a rounding error of its own edges.
TEST(TetMesh, FindsATetrahedronWhoseVolumeIsTheRoundingOfItsCoordinates) {
  constexpr double kFar = 1e6, kEdge = 1e-3;
  Eigen::Matrix<double, 3, 4> corners;
  corners << 0, kEdge, 0, 0, 0, 0, kEdge, 0, 0, 0, 0, kEdge;
  TetMesh one{corners.array() + kFar, Eigen::Vector4i(0, 1, 2, 3)};
  EXPECT_EQ(FindFlatTet(one), -1);
  one.nodes(2, 3) = std::nextafter(kFar, 2 * kFar);
  EXPECT_EQ(FindFlatTet(one), 0);
}

TEST(TetMesh, VolumeOfCurvatureIsThatBetweenCurvedEdgesAndTheirChords) {
  EXPECT_EQ(VolumeOfCurvature(Box()), 0);
  EXPECT_EQ(VolumeOfCurvature(ToQuadratic(Box())), 0);
  Eigen::Matrix<double, 3, 4> corners;
  corners << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  TetMesh one = ToQuadratic({corners, Eigen::Vector4i(0, 1, 2, 3)});
  EXPECT_TRUE(HasStraightEdges(one, 0));
  // With the midpoint of the edge (1,2) at (0.5 + d, 0.5 + d, 0), the determinant is
  // 1 + 4 d (ξ_1 + ξ_2), whose integral is 1/6 + d/3.
  constexpr double kShift = 0.1;
  one.nodes.col(one.tets(5, 0)) += Vector3d(kShift, kShift, 0);
  EXPECT_FALSE(HasStraightEdges(one, 0));
  EXPECT_NEAR(VolumeOfCurvature(one), kShift / 3, 1e-15);
}

TEST(ToQuadratic, PutsOneNodeOnTheMiddleOfEachEdge) {
  const TetMesh linear = Box(), quadratic = ToQuadratic(linear);
  EXPECT_EQ(quadratic.Order(), 2);
  EXPECT_EQ(quadratic.nodes.leftCols(linear.NodeCount()), linear.nodes);
  EXPECT_EQ(quadratic.tets.topRows(4), linear.tets);
  // Euler's formula for a ball: V − E + F − T = 1, with 2F = 4T + boundary faces.
  const auto boundary_faces = ExtractBoundary(linear).faces.cols();
  const auto faces = (4 * linear.TetCount() + boundary_faces) / 2;
  EXPECT_EQ(quadratic.NodeCount() - linear.NodeCount(),
            linear.NodeCount() + faces - linear.TetCount() - 1);
  const int edges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (Eigen::Index e = 0; e < quadratic.TetCount(); ++e) {
    for (int k = 0; k < 6; ++k) {
      const Vector3d middle = 0.5 * (linear.nodes.col(linear.tets(edges[k][0], e)) +
                                     linear.nodes.col(linear.tets(edges[k][1], e)));
      EXPECT_EQ(Vector3d(quadratic.nodes.col(quadratic.tets(4 + k, e))), middle);
    }
  }
}

TEST(ToQuadratic, ReturnsAQuadraticMeshUnchanged) {
  const TetMesh once = ToQuadratic(Box()), twice = ToQuadratic(once);
  EXPECT_EQ(once.nodes, twice.nodes);
  EXPECT_EQ(once.tets, twice.tets);
}

class BoundaryOfOrder : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Orders, BoundaryOfOrder, ::testing::Values(1, 2));

TEST_P(BoundaryOfOrder, IsAClosedOutwardSurfaceOfTheSameVolume) {
  const TetMesh mesh = GetParam() == 2 ? ToQuadratic(Box()) : Box();
  const BoundarySurface boundary = ExtractBoundary(mesh);
  const SurfaceReport report = CheckSurface(boundary.surface);
  EXPECT_TRUE(report.BoundsVolume()) << DescribeFaults(report);
  EXPECT_EQ(report.euler_characteristic, 2);
  EXPECT_EQ(report.unused_vertices, 0);
  EXPECT_NEAR(report.volume, kBoxVolume, 1e-13 * kBoxVolume);
  EXPECT_EQ(boundary.faces.rows(), GetParam() == 2 ? 6 : 3);
  EXPECT_EQ(boundary.surface.triangles.cols(), boundary.faces.cols() * (GetParam() == 2 ? 4 : 1));
}

TEST_P(BoundaryOfOrder, NamesTheNodesOfTheMesh) {
  const TetMesh mesh = GetParam() == 2 ? ToQuadratic(Box()) : Box();
  const BoundarySurface boundary = ExtractBoundary(mesh);
  EXPECT_EQ(boundary.surface.vertices, mesh.nodes(Eigen::all, boundary.node));
  // Exactly the nodes on the box's sides are on the boundary.
  Eigen::Index on_sides = 0;
  const Eigen::Array3d size(0.2, 0.03, 0.04);
  for (const auto node : mesh.nodes.colwise()) {
    on_sides += ((node.array().abs() < 1e-12) || ((node.array() - size).abs() < 1e-12)).any();
  }
  EXPECT_EQ(boundary.node.size(), on_sides);
}

TEST_P(BoundaryOfOrder, FollowsMovedNodes) {
  const TetMesh mesh = GetParam() == 2 ? ToQuadratic(Box()) : Box();
  const BoundarySurface boundary = ExtractBoundary(mesh);
  const TriMesh moved = BoundaryAt(boundary, 2 * mesh.nodes);
  EXPECT_EQ(moved.triangles, boundary.surface.triangles);
  EXPECT_NEAR(EnclosedVolume(moved), 8 * kBoxVolume, 1e-12 * kBoxVolume);
}

TEST(ExtractBoundary, OfOrderTwoPutsEdgeNodesBetweenTheirCorners) {
  const TetMesh mesh = ToQuadratic(Box());
  const Eigen::MatrixXi faces = ExtractBoundary(mesh).faces;
  for (const auto face : faces.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d middle = 0.5 * (mesh.nodes.col(face(k)) + mesh.nodes.col(face((k + 1) % 3)));
      EXPECT_LT((mesh.nodes.col(face(3 + k)) - middle).norm(), 1e-15);
    }
  }
}

TEST(ExtractBoundary, FindsTheWallOfACavity) {
  TetMesh mesh = BoxMesh(Vector3d::Zero(), Vector3d::Ones(), {3, 3, 3});
  std::vector<int> kept;
  for (int e = 0; e < mesh.TetCount(); ++e) {
    const Vector3d centre = mesh.nodes(Eigen::all, mesh.tets.col(e)).rowwise().mean();
    const Vector3d offset = centre - Vector3d::Constant(0.5);
    if (offset.cwiseAbs().maxCoeff() > 1.0 / 6) kept.push_back(e);
  }
  mesh.tets = mesh.tets(Eigen::all, kept).eval();
  const SurfaceReport report = CheckSurface(ExtractBoundary(mesh).surface);
  EXPECT_EQ(report.components, 2);
  EXPECT_EQ(report.inside_out_components.size(), 1u);  // seen from the material, it is outward
  EXPECT_NEAR(report.volume, 26.0 / 27, 1e-13);
}

}  // namespace
}  // namespace lacuna
