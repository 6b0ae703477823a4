#include "geometry/tri_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/shapes.h"

namespace lacuna {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

TEST(TriMesh, BoxHasItsAreaVolumeAndBoundingBox) {
  TriMesh box = BoxSurface({0.2, 0.03, 0.04}, {4, 2, 3});
  // Measures of flat faces are exact to rounding.
  EXPECT_NEAR(TriangleAreas(box).sum(), 2 * (0.2 * 0.03 + 0.03 * 0.04 + 0.04 * 0.2), 1e-16);
  EXPECT_NEAR(EnclosedVolume(box), 0.2 * 0.03 * 0.04, 1e-18);
  EXPECT_NEAR(VertexAreas(box).sum(), TriangleAreas(box).sum(), 1e-16);
  EXPECT_DOUBLE_EQ(BoundingBoxDiagonal(box.vertices), Vector3d(0.2, 0.03, 0.04).norm());

  box.triangles.row(0).swap(box.triangles.row(1));
  EXPECT_NEAR(EnclosedVolume(box), -0.2 * 0.03 * 0.04, 1e-18);
}

TEST(TriMesh, VolumeKeepsItsDigitsFarFromTheOrigin) {
  TriMesh box = BoxSurface({0.2, 0.03, 0.04}, {4, 2, 3});
  box.vertices.colwise() += Vector3d(1000, -2000, 500);
  // The coordinates themselves carry 2e-13 of 0.03 m; a sum about the origin would lose far more.
  EXPECT_NEAR(EnclosedVolume(box), 0.2 * 0.03 * 0.04, 1e-10 * 0.2 * 0.03 * 0.04);
}

TEST(TriMesh, SphereApproachesItsAreaAndVolumeAtSecondOrder) {
  double area_error[2], volume_error[2];
  for (int level : {0, 1}) {
    const TriMesh sphere = Icosphere(2, 3 + level);
    area_error[level] = 16 * pi - TriangleAreas(sphere).sum();
    volume_error[level] = 32 * pi / 3 - EnclosedVolume(sphere);
  }
  // Halved edges quarter the error; the next term of the series is smaller by the edge squared.
  EXPECT_NEAR(area_error[0] / area_error[1], 4, 0.05);
  EXPECT_NEAR(volume_error[0] / volume_error[1], 4, 0.05);
}

TEST(TriMesh, NormalsOfASphereAreRadial) {
  const TriMesh sphere = Icosphere(0.1, 4);
  const Eigen::Matrix3Xd of_vertices = VertexNormals(sphere);
  const Eigen::Matrix3Xd of_triangles = TriangleNormals(sphere);
  for (Eigen::Index v = 0; v < sphere.vertices.cols(); ++v) {
    EXPECT_NEAR(of_vertices.col(v).norm(), 1, 1e-14);
    // Triangles around a vertex differ in size by a tenth or so and tilt by 0.04 rad: their mean
    // leans by less than 0.01 rad.
    EXPECT_GT(of_vertices.col(v).dot(sphere.vertices.col(v).normalized()), std::cos(0.01));
  }
  for (Eigen::Index t = 0; t < sphere.triangles.cols(); ++t) {
    const Vector3d centre = sphere.vertices(Eigen::all, sphere.triangles.col(t)).rowwise().mean();
    EXPECT_GT(of_triangles.col(t).dot(centre.normalized()), 1 - 1e-4);
  }
}

TEST(TriMesh, NormalsAreZeroWhereThereIsNoArea) {
  const TriMesh mesh = MeshOf({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {5, 5, 5}}, {{0, 1, 2}});
  EXPECT_EQ(TriangleNormals(mesh).col(0), Vector3d::Zero());
  EXPECT_EQ(VertexNormals(mesh).col(3), Vector3d::Zero());
}

TEST(TriMesh, TinyTrianglesStillHaveUnitNormals) {
  const TriMesh mesh = MeshOf({{0, 0, 0}, {1e-120, 0, 0}, {0, 1e-120, 0}}, {{0, 1, 2}});
  EXPECT_NEAR(TriangleNormals(mesh).col(0).z(), 1, 1e-14);
}

TEST(SampleSurface, SpreadsPointsInProportionToArea) {
  const TriMesh body = OrganicSurface(3);
  const Eigen::VectorXd areas = TriangleAreas(body);
  constexpr int kCount = 200000;
  const SurfaceSamples samples = SampleSurface(body, kCount, 7);
  Eigen::VectorXd hits = Eigen::VectorXd::Zero(areas.size());
  for (const int t : samples.triangle) ++hits(t);
  // Strata of equal area, one sample in each: a triangle's count strays from its share by the two
  // strata at its ends.
  EXPECT_LE((hits - kCount / areas.sum() * areas).cwiseAbs().maxCoeff(), 2.0);
  EXPECT_NEAR((samples.barycentric.colwise().sum().array() - 1).abs().maxCoeff(), 0, 1e-15);
  EXPECT_GE(samples.barycentric.minCoeff(), 0);
  // Inside a triangle the barycentric coordinates average 1/3, with a standard error of
  // 0.236/√200000 = 0.0005.
  EXPECT_LT((samples.barycentric.rowwise().mean().array() - 1.0 / 3).abs().maxCoeff(), 0.003);
}

TEST(SampleSurface, IsReproducibleForTheSameSeedOnly) {
  const TriMesh body = OrganicSurface(2);
  const SurfaceSamples first = SampleSurface(body, 100, 1);
  EXPECT_EQ(first.barycentric, SampleSurface(body, 100, 1).barycentric);
  EXPECT_EQ(first.triangle, SampleSurface(body, 100, 1).triangle);
  EXPECT_NE(first.barycentric, SampleSurface(body, 100, 2).barycentric);
}

TEST(SampleSurface, NeverSamplesATriangleWithoutArea) {
  const TriMesh mesh =
      MeshOf({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {2, 0, 0}}, {{0, 1, 3}, {0, 1, 2}, {0, 1, 3}});
  for (const int t : SampleSurface(mesh, 1000, 3).triangle) EXPECT_EQ(t, 1);
}

TEST(EvaluateSamples, FollowsTheSameMaterialPointsThroughADeformation) {
  const TriMesh rest = OrganicSurface(2);
  const SurfaceSamples samples = SampleSurface(rest, 500, 11);
  TriMesh moved = rest;
  Eigen::Matrix3d linear;
  linear << 1.1, 0.2, 0, -0.1, 0.9, 0.3, 0, 0.1, 1.2;
  moved.vertices = (linear * rest.vertices).colwise() + Vector3d(1, 2, 3);
  const PointCloud before = EvaluateSamples(rest, samples), after = EvaluateSamples(moved, samples);
  // Barycentric points follow an affine map exactly, to rounding of numbers of size 5.
  EXPECT_LT(((linear * before.points).colwise() + Vector3d(1, 2, 3) - after.points).norm(), 1e-12);
  EXPECT_TRUE(after.HasNormals());
  EXPECT_NEAR((after.normals.colwise().norm().array() - 1).abs().maxCoeff(), 0, 1e-14);
}

}  // namespace
}  // namespace lacuna
