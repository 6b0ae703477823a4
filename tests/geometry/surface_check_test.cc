#include "geometry/surface_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/self_intersection.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;
using ::testing::HasSubstr;

TriMesh Without(const TriMesh& mesh, const std::vector<int>& dropped) {
  std::vector<int> kept;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (std::find(dropped.begin(), dropped.end(), t) == dropped.end()) kept.push_back(t);
  }
  return {mesh.vertices, mesh.triangles(Eigen::all, kept)};
}

TEST(CheckSurface, FindsNoFaultInASphere) {
  const SurfaceReport report = CheckSurface(Icosphere(0.1, 3));
  EXPECT_TRUE(report.BoundsVolume());
  EXPECT_EQ(DescribeFaults(report), "");
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler_characteristic, 2);
  EXPECT_EQ(report.triangles, 20 * 64);
  EXPECT_EQ(report.vertices, 2 + 10 * 64);
  EXPECT_GT(report.min_edge, 0.8 * report.mean_edge);
  EXPECT_GT(report.min_angle, 50 * std::numbers::pi / 180);
}

TEST(CheckSurface, CountsTheHandleOfATorus) {
  // A grid that is closed in both directions.
  constexpr int kAround = 24, kAcross = 12;
  std::vector<Vector3d> vertices;
  std::vector<std::array<int, 3>> triangles;
  for (int i = 0; i < kAround; ++i) {
    for (int j = 0; j < kAcross; ++j) {
      const double u = 2 * std::numbers::pi * i / kAround, v = 2 * std::numbers::pi * j / kAcross;
      const double r = 1 + 0.3 * std::cos(v);
      vertices.emplace_back(r * std::cos(u), r * std::sin(u), 0.3 * std::sin(v));
      const int a = i * kAcross + j, b = (i + 1) % kAround * kAcross + j;
      const int c = i * kAcross + (j + 1) % kAcross;
      const int d = (i + 1) % kAround * kAcross + (j + 1) % kAcross;
      triangles.push_back({a, b, d});
      triangles.push_back({a, d, c});
    }
  }
  const SurfaceReport report = CheckSurface(MeshOf(vertices, triangles));
  EXPECT_TRUE(report.BoundsVolume()) << DescribeFaults(report);
  EXPECT_EQ(report.euler_characteristic, 0);
}

TEST(CheckSurface, ReportsTheLocationsOfHoles) {
  const TriMesh sphere = Icosphere(1, 2);
  const SurfaceReport report = CheckSurface(Without(sphere, {0, 200}));
  EXPECT_FALSE(report.IsClosed());
  EXPECT_FALSE(report.BoundsVolume());
  ASSERT_EQ(report.boundary_loops.size(), 2u);
  EXPECT_GE(report.boundary_loops[0].length, report.boundary_loops[1].length);
  for (const BoundaryLoop& loop : report.boundary_loops) {
    EXPECT_EQ(loop.edges, 3);
    bool found = false;
    for (const int t : {0, 200}) {
      const Vector3d centre = sphere.vertices(Eigen::all, sphere.triangles.col(t)).rowwise().mean();
      // Weighting by length shifts the centre a little within the triangle of edge 0.3.
      found |= (loop.centre - centre).norm() < 0.03;
    }
    EXPECT_TRUE(found);
  }
  EXPECT_THAT(DescribeFaults(report), HasSubstr("2 holes"));
}

TEST(CheckSurface, FindsAReversedTriangle) {
  TriMesh sphere = Icosphere(1, 2);
  std::swap(sphere.triangles(0, 17), sphere.triangles(1, 17));
  const SurfaceReport report = CheckSurface(sphere);
  EXPECT_EQ(report.misoriented_edges.size(), 3u);
  EXPECT_TRUE(report.IsClosed());
  EXPECT_FALSE(report.BoundsVolume());
  const Vector3d centre = sphere.vertices(Eigen::all, sphere.triangles.col(17)).rowwise().mean();
  for (const Vector3d& place : report.misoriented_edges) EXPECT_LT((place - centre).norm(), 0.2);
}

TEST(CheckSurface, FindsAnInsideOutBody) {
  TriMesh sphere = Icosphere(1, 2);
  sphere.triangles.row(0).swap(sphere.triangles.row(1));
  const SurfaceReport report = CheckSurface(sphere);
  EXPECT_TRUE(report.IsOriented());
  EXPECT_FALSE(report.IsOutward());
  EXPECT_THAT(DescribeFaults(report), HasSubstr("inside out"));
}

// The two sides of one triangle, which enclose nothing.
TEST(CheckSurface, FindsAClosedComponentWithoutVolume) {
  const TriMesh sides =
      MeshOf({{0.1, 0.2, 0.3}, {1, 0, 0.1}, {0.2, 1, 0.7}}, {{0, 1, 2}, {0, 2, 1}});
  const SurfaceReport report = CheckSurface(Together(Icosphere(1, 2), sides), false);
  EXPECT_EQ(report.flat_components.size(), 1u);
  EXPECT_TRUE(report.inside_out_components.empty());
  EXPECT_FALSE(report.IsOutward());
  EXPECT_THAT(DescribeFaults(report), HasSubstr("1 × closed component without volume"));
}

TEST(CheckSurface, FindsEdgesOfThreeTriangles) {
  TriMesh sphere = Icosphere(1, 2);
  const int a = sphere.triangles(0, 5), b = sphere.triangles(1, 5);
  const Vector3d middle = 0.5 * (sphere.vertices.col(a) + sphere.vertices.col(b));
  const int fin = static_cast<int>(sphere.vertices.cols());
  sphere.vertices.conservativeResize(3, fin + 1);
  sphere.vertices.col(fin) = 2 * middle;
  sphere.triangles.conservativeResize(3, sphere.triangles.cols() + 1);
  sphere.triangles.rightCols(1) << a, b, fin;
  const SurfaceReport report = CheckSurface(sphere);
  ASSERT_EQ(report.nonmanifold_edges.size(), 1u);
  EXPECT_LT((report.nonmanifold_edges[0] - middle).norm(), 1e-15);
  EXPECT_FALSE(report.IsManifold());
}

TEST(CheckSurface, FindsVerticesWhereBodiesTouch) {
  // Two tetrahedra with one corner in common.
  const TriMesh mesh = MeshOf(
      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}},
      {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 4, 5}, {0, 6, 4}, {0, 5, 6}, {4, 6, 5}});
  const SurfaceReport report = CheckSurface(mesh);
  ASSERT_EQ(report.nonmanifold_vertices.size(), 1u);
  EXPECT_EQ(report.nonmanifold_vertices[0], Vector3d::Zero());
  EXPECT_EQ(report.components, 2);
  EXPECT_TRUE(report.nonmanifold_edges.empty());
}

TEST(CheckSurface, FindsTrianglesWithoutArea) {
  TriMesh sphere = Icosphere(1, 1);
  sphere.vertices.col(sphere.triangles(0, 3)) = sphere.vertices.col(sphere.triangles(1, 3));
  EXPECT_FALSE(CheckSurface(sphere).degenerate_triangles.empty());
  EXPECT_FALSE(CheckSurface(sphere).BoundsVolume());
}

TEST(CheckSurface, ReportsAnEmptyMeshAsNotClosed) {
  const SurfaceReport report = CheckSurface({});
  EXPECT_FALSE(report.IsClosed());
  EXPECT_FALSE(report.BoundsVolume());
  EXPECT_THAT(DescribeFaults(report), HasSubstr("no triangles"));
}

TEST(FindSelfIntersections, FindsWhereTwoSpheresCross) {
  TriMesh other = Icosphere(1, 2);
  other.vertices.row(0).array() += 1.5;
  const auto crossings = FindSelfIntersections(Together(Icosphere(1, 2), other));
  ASSERT_FALSE(crossings.empty());
  for (const SelfIntersection& crossing : crossings) {
    EXPECT_LT(crossing.first, 320);
    EXPECT_GE(crossing.second, 320);
    // The spheres meet in the plane x = 0.75 in a circle of radius 0.66; triangles have edges of
    // about 0.3.
    EXPECT_NEAR(crossing.place.x(), 0.75, 0.15);
    EXPECT_NEAR(crossing.place.tail<2>().norm(), 0.66, 0.2);
  }
}

TEST(FindSelfIntersections, FindsNoneBetweenNestedOrDistantBodies) {
  TriMesh distant = Icosphere(1, 2);
  distant.vertices.row(0).array() += 2.001;
  EXPECT_TRUE(FindSelfIntersections(Together(Icosphere(1, 2), distant)).empty());
  EXPECT_TRUE(FindSelfIntersections(Together(Icosphere(1, 2), Icosphere(0.5, 2))).empty());
}

// Pairs of triangles that share vertices are separate cases in the implementation.
TEST(FindSelfIntersections, HandlesTrianglesThatShareAnEdge) {
  const std::vector<Vector3d> v{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.2, 0.5, 0}};
  EXPECT_TRUE(FindSelfIntersections(MeshOf(v, {{0, 1, 2}, {2, 1, 3}})).empty());
  EXPECT_EQ(FindSelfIntersections(MeshOf(v, {{0, 1, 2}, {2, 1, 4}})).size(), 1u);  // folded back
  EXPECT_EQ(FindSelfIntersections(MeshOf(v, {{0, 1, 2}, {1, 0, 2}})).size(), 1u);  // the same again
}

TEST(FindSelfIntersections, HandlesTrianglesThatShareAVertex) {
  const std::vector<Vector3d> v{{0, 0, 0},     {1, 0, 0},      {0, 1, 0},
                                {-1, 0, 0},    {0, -1, 0},     {0.3, 0.3, -1},
                                {0.3, 0.3, 1}, {0.6, 0.6, -1}, {0.6, 0.6, 1}};
  EXPECT_TRUE(FindSelfIntersections(MeshOf(v, {{0, 1, 2}, {0, 3, 4}})).empty());
  EXPECT_EQ(FindSelfIntersections(MeshOf(v, {{0, 1, 2}, {0, 5, 6}})).size(), 1u);
  // The second triangle crosses the first from their common vertex to the opposite edge.
  EXPECT_EQ(FindSelfIntersections(MeshOf(v, {{0, 1, 2}, {0, 7, 8}})).size(), 1u);
}

TEST(FindSelfIntersections, CountsTouchingTriangles) {
  const std::vector<Vector3d> v{{0, 0, 0},     {1, 0, 0},     {0, 1, 0},       {0.2, 0.2, 0},
                                {0.2, 0.2, 1}, {0.5, 0.2, 1}, {0.2, 0.2, 1e-9}};
  EXPECT_EQ(FindSelfIntersections(MeshOf(v, {{0, 1, 2}, {3, 4, 5}})).size(), 1u);
  EXPECT_TRUE(FindSelfIntersections(MeshOf(v, {{0, 1, 2}, {6, 4, 5}})).empty());
}

}  // namespace
}  // namespace lacuna
