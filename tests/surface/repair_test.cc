#include "surface/repair.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/surface_check.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

void ExpectSound(const RepairedSurface& repaired) {
  const SurfaceReport report = CheckSurface(repaired.mesh);
  EXPECT_TRUE(report.BoundsVolume()) << DescribeFaults(report);
  EXPECT_EQ(report.components, 1);
}

TEST(RepairSurface, KeepsAValidSurfaceUnchanged) {
  const TriMesh sphere = Icosphere(0.1, 3);
  const RepairedSurface repaired = RepairSurface(sphere);
  EXPECT_THAT(repaired.notes, IsEmpty());
  EXPECT_EQ(repaired.mesh.vertices, sphere.vertices);
  EXPECT_EQ(repaired.mesh.triangles.cols(), sphere.triangles.cols());
}

TEST(RepairSurface, JoinsASoupOfTriangles) {
  const TriMesh sphere = Icosphere(0.1, 3);
  TriMesh soup{Eigen::Matrix3Xd(3, 3 * sphere.triangles.cols()),
               Eigen::Matrix3Xi(3, sphere.triangles.cols())};
  for (Eigen::Index t = 0; t < sphere.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      soup.vertices.col(3 * t + k) = sphere.vertices.col(sphere.triangles(k, t));
      soup.triangles(k, t) = static_cast<int>(3 * t + k);
    }
    if (t % 3 == 0) soup.triangles.col(t).head<2>().reverseInPlace();  // turned the wrong way
  }
  const RepairedSurface repaired = RepairSurface(soup);
  ExpectSound(repaired);
  EXPECT_EQ(repaired.mesh.vertices.cols(), sphere.vertices.cols());
  EXPECT_NEAR(EnclosedVolume(repaired.mesh), EnclosedVolume(sphere), 1e-17);
}

TEST(RepairSurface, KeepsTheLargestComponent) {
  TriMesh crumb = Icosphere(0.01, 3);  // small, though of more triangles
  crumb.vertices.row(0).array() += 0.2;
  const RepairedSurface repaired = RepairSurface(Together(Icosphere(0.1, 2), crumb));
  ExpectSound(repaired);
  EXPECT_NEAR(BoundingBox(repaired.mesh.vertices).max().x(), 0.1, 0.005);
  EXPECT_THAT(repaired.notes, Contains(HasSubstr("removed 1 small components")));
}

TEST(RepairSurface, RemovesSlivers) {
  TriMesh sphere = Icosphere(0.1, 3);
  // Triangles split at a point just beside one of their edges: a cap each.
  const Eigen::Index count = sphere.triangles.cols();
  sphere.vertices.conservativeResize(3, sphere.vertices.cols() + 20);
  sphere.triangles.conservativeResize(3, count + 40);
  for (int k = 0; k < 20; ++k) {
    const Eigen::Vector3i t = sphere.triangles.col(30 * k);
    const int middle = static_cast<int>(sphere.vertices.cols()) - 20 + k;
    sphere.vertices.col(middle) = 0.4995 * sphere.vertices.col(t(0)) +
                                  0.4995 * sphere.vertices.col(t(1)) +
                                  0.001 * sphere.vertices.col(t(2));
    sphere.triangles.col(30 * k) << t(0), t(1), middle;
    sphere.triangles.col(count + 2 * k) << t(1), t(2), middle;
    sphere.triangles.col(count + 2 * k + 1) << t(2), t(0), middle;
  }
  ASSERT_LT(CheckSurface(sphere).min_angle, 0.01);
  const RepairedSurface repaired = RepairSurface(sphere);
  ExpectSound(repaired);
  EXPECT_GT(CheckSurface(repaired.mesh).min_angle, 10 * std::numbers::pi / 180);
  EXPECT_NEAR(EnclosedVolume(repaired.mesh), EnclosedVolume(sphere), 1e-3 * EnclosedVolume(sphere));
}

TEST(RepairSurface, FillsHolesAndReportsWhere) {
  TriMesh sphere = Icosphere(0.1, 3);
  std::vector<int> kept;
  for (int t = 0; t < sphere.triangles.cols(); ++t) {
    const Eigen::Vector3d centre =
        sphere.vertices(Eigen::all, sphere.triangles.col(t)).rowwise().mean();
    if (centre.z() < 0.08 && t != 100) kept.push_back(t);
  }
  sphere.triangles = sphere.triangles(Eigen::all, kept).eval();
  ASSERT_EQ(CheckSurface(sphere).boundary_loops.size(), 2u);

  const RepairedSurface all = RepairSurface(sphere);
  ExpectSound(all);
  EXPECT_TRUE(CheckSurface(all.mesh).boundary_loops.empty());
  EXPECT_THAT(all.notes, Contains(HasSubstr("filled a hole of perimeter")).Times(2));
}

TEST(RepairSurface, OrientsABodyOutward) {
  TriMesh sphere = Icosphere(0.1, 3);
  sphere.triangles.row(0).swap(sphere.triangles.row(1));
  const RepairedSurface repaired = RepairSurface(sphere);
  ExpectSound(repaired);
  EXPECT_THAT(repaired.notes, Contains(HasSubstr("normals pointed inward")));
}

TEST(RepairSurface, RemovesSelfIntersections) {
  TriMesh sphere = Icosphere(0.1, 3);
  // A vertex pushed through the far side.
  sphere.vertices.col(300) *= -1.2;
  ASSERT_FALSE(CheckSurface(sphere).IsFreeOfIntersections());
  const RepairedSurface repaired = RepairSurface(sphere);
  ExpectSound(repaired);
  EXPECT_THAT(repaired.notes, Contains(HasSubstr("self-intersections")));
  EXPECT_NEAR(EnclosedVolume(repaired.mesh), 4.0 / 3 * std::numbers::pi * 1e-3, 1e-4);
}

TEST(RepairSurface, SplitsBodiesAtANonManifoldEdge) {
  // Two tetrahedra with one edge in common.
  const TriMesh mesh = MeshOf(
      {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}},
      {{0, 3, 2}, {1, 2, 3}, {0, 1, 3}, {0, 2, 1}, {0, 5, 4}, {1, 4, 5}, {0, 1, 5}, {0, 4, 1}});
  ASSERT_FALSE(CheckSurface(mesh).IsManifold());
  const RepairedSurface repaired = RepairSurface(mesh);
  ExpectSound(repaired);
  EXPECT_EQ(repaired.mesh.triangles.cols(), 4);
}

TEST(RepairSurface, ReturnsAnEmptyMeshForAnEmptyMesh) {
  EXPECT_EQ(RepairSurface({}).mesh.triangles.cols(), 0);
}

}  // namespace
}  // namespace lacuna
