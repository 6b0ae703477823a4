#include "surface/reconstruct.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "core/error.h"
#include "core/parallel.h"
#include "geometry/nearest.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

// Samples of `truth` with Gaussian noise (m, in each coordinate) and with normals that are wrong by
// about 0.2 rad, like those of a scanner.
PointCloud Scan(const TriMesh& truth, int count, double noise, uint64_t seed) {
  PointCloud cloud = EvaluateSamples(truth, SampleSurface(truth, count, seed));
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> gauss;
  const auto vector = [&] {
    const double x = gauss(generator), y = gauss(generator), z = gauss(generator);
    return Eigen::Vector3d(x, y, z);
  };
  for (Eigen::Index i = 0; i < cloud.Size(); ++i) {
    cloud.points.col(i) += noise * vector();
    cloud.normals.col(i) = (cloud.normals.col(i) + 0.15 * vector()).normalized();
  }
  return cloud;
}

struct Error {
  double mean, largest;
};
Error ErrorAgainst(const TriMesh& truth, const TriMesh& mesh) {
  const Eigen::Matrix3Xd points = EvaluateSamples(mesh, SampleSurface(mesh, 5000, 1)).points;
  const Eigen::VectorXd distance = SurfaceSearch(truth).Nearest(points).distance;
  return {distance.mean(), distance.maxCoeff()};
}

TriMesh Ellipsoid() {
  TriMesh mesh = Icosphere(0.05, 5);
  mesh.vertices.row(0) *= 2;
  mesh.vertices.row(1) *= 1.3;
  return mesh;
}

TEST(TypicalSpacing, IsThatOfAGridOnAPlane) {
  const TriMesh sheet = FlatSheet(1, 1, 50, 50);
  // A square grid's eighth neighbour is √2 spacings away: √(π/8)·√2 = 0.886.
  EXPECT_NEAR(TypicalSpacing(sheet.vertices), 0.886 * 0.02, 1e-4);
  // Random points: one per spacing², within the noise of a median over 10 000.
  const PointCloud cloud = EvaluateSamples(sheet, SampleSurface(sheet, 10000, 1));
  EXPECT_NEAR(TypicalSpacing(cloud.points), 0.01, 0.0007);
}

class NoisyScan : public ::testing::TestWithParam<std::tuple<int, double>> {};
INSTANTIATE_TEST_SUITE_P(All, NoisyScan,
                         ::testing::Combine(::testing::Values(0, 1, 2),
                                            ::testing::Values(0.0, 0.002, 0.005)));

TEST_P(NoisyScan, GivesAClosedSurfaceNearTheTruth) {
  const auto& [shape, relative_noise] = GetParam();
  const TriMesh truth = shape == 0   ? Icosphere(0.05, 5)
                        : shape == 1 ? Ellipsoid()
                                     : OrganicSurface(5);
  const double size = BoundingBoxDiagonal(truth.vertices);
  const double noise = relative_noise * size;
  const Surface surface = ReconstructSurface(Scan(truth, 6000, noise, 5), {});
  ASSERT_TRUE(surface.IsUsable()) << surface.message;
  EXPECT_TRUE(surface.report.BoundsVolume());
  EXPECT_EQ(surface.report.euler_characteristic, 2);
  const Error error = ErrorAgainst(truth, surface.mesh);
  // Beside half of the noise, what edges of two spacings make of the curvature: an eighth of
  // edge² over the radius, up to some 0.1 % of the size.
  EXPECT_LT(error.mean, 0.5 * noise + 0.001 * size);
  EXPECT_LT(error.largest, 2 * noise + 0.005 * size);
  EXPECT_NEAR(surface.report.volume, EnclosedVolume(truth), 0.015 * EnclosedVolume(truth));
}

TEST(ReconstructSurface, PrintsNothingOnStandardOutput) {
  // A body with sharp edges, at which PCL's iso-surface has loops that do not close.
  const TriMesh box = BoxSurface({0.2, 0.03, 0.04}, {20, 3, 4});
  ::testing::internal::CaptureStdout();
  const Surface surface =
      ReconstructSurface(Scan(box, 2000, 0.002 * BoundingBoxDiagonal(box.vertices), 1), {});
  EXPECT_EQ(::testing::internal::GetCapturedStdout(), "");
  EXPECT_TRUE(surface.IsUsable()) << surface.message;
}

TEST(ReconstructSurface, GivesUniformTrianglesOfTheRequestedSize) {
  const PointCloud cloud = Scan(Ellipsoid(), 6000, 1e-4, 2);
  for (const double edge : {0.004, 0.008}) {
    const Surface surface = ReconstructSurface(cloud, {.edge_length = edge});
    ASSERT_TRUE(surface.IsUsable()) << surface.message;
    EXPECT_NEAR(surface.report.mean_edge, edge, 0.15 * edge);
    EXPECT_LT(surface.report.max_edge, 2 * edge);
    EXPECT_GT(surface.report.min_angle, 0.35);  // 20°: no slivers
  }
}

TEST(ReconstructSurface, IsReproducibleForAnyNumberOfThreads) {
  const PointCloud cloud = Scan(OrganicSurface(4), 5000, 0.005, 3);
  SetThreadCount(1);
  const Surface one = ReconstructSurface(cloud, {});
  SetThreadCount(2);
  const Surface two = ReconstructSurface(cloud, {});
  ASSERT_TRUE(one.IsUsable()) << one.message;
  EXPECT_EQ(one.mesh.vertices, two.mesh.vertices);
  EXPECT_EQ(one.mesh.triangles, two.mesh.triangles);
}

TEST(ReconstructSurface, ClosesTheUnseenSide) {
  PointCloud cloud = Scan(Icosphere(0.05, 5), 8000, 1e-4, 4);
  std::vector<int> seen;
  for (int i = 0; i < cloud.Size(); ++i) {
    if (cloud.points(2, i) > -0.035) seen.push_back(i);
  }
  cloud = {cloud.points(Eigen::all, seen).eval(), cloud.normals(Eigen::all, seen).eval()};
  const Surface surface = ReconstructSurface(cloud, {});
  ASSERT_TRUE(surface.IsUsable()) << surface.message;
  // The missing cap holds 6 % of the ball, and the patch across it bulges somewhere between flat
  // and more than round.
  EXPECT_NEAR(surface.report.volume, 4.18879 * std::pow(0.05, 3),
              0.07 * 4.18879 * std::pow(0.05, 3));
}

TEST(ReconstructSurface, ReversesASurfaceWithInwardNormalsWithANote) {
  PointCloud cloud = Scan(Icosphere(0.05, 4), 4000, 0, 6);
  cloud.normals *= -1;
  const Surface surface = ReconstructSurface(cloud, {});
  ASSERT_TRUE(surface.IsUsable()) << surface.message;
  EXPECT_THAT(surface.notes, ::testing::Contains(HasSubstr("normals pointed inward")));
  // Less the chords of edges of two spacings.
  EXPECT_NEAR(surface.report.volume / (4.18879 * std::pow(0.05, 3)), 1, 0.01);
}

TEST(ReconstructSurface, DoesNotReportNoiseAsASurface) {
  // Points and normals at random in a cube.
  std::mt19937_64 generator(7);
  PointCloud cloud{Eigen::Matrix3Xd(3, 1000), Eigen::Matrix3Xd(3, 1000)};
  for (double& x : cloud.points.reshaped()) x = static_cast<double>(generator() >> 11) * 0x1p-53;
  for (double& x : cloud.normals.reshaped()) {
    x = static_cast<double>(generator() >> 11) * 0x1p-53 - 0.5;
  }
  cloud.normals.colwise().normalize();
  const Surface surface = ReconstructSurface(cloud, {});
  // The result is either valid or reported as faulty with a location.
  EXPECT_EQ(surface.IsUsable(), surface.report.BoundsVolume());
  EXPECT_EQ(surface.IsUsable(), surface.message.empty());
}

std::string FailureOf(const PointCloud& cloud) {
  try {
    ReconstructSurface(cloud, {});
  } catch (const InputError& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(ReconstructSurface, RefusesTooManyTrianglesBeforeCreatingThem) {
  SurfaceOptions options;
  options.edge_length = 1e-4;  // 12.6 m² of a unit sphere: 3e9 triangles
  try {
    ReconstructSurface(Scan(Icosphere(1, 3), 500, 0, 1), options);
    FAIL() << "nothing was refused";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("check the recording's length_unit"));
  }
}

TEST(ReconstructSurface, RefusesCloudsWithoutASurface) {
  EXPECT_THAT(FailureOf({}), HasSubstr("at least 10 points, got 0"));
  PointCloud cloud = Scan(Icosphere(1, 3), 500, 0, 1);
  EXPECT_THAT(FailureOf({cloud.points.leftCols(1), cloud.normals.leftCols(1)}), HasSubstr("got 1"));
  EXPECT_THAT(FailureOf({cloud.points, {}}), HasSubstr("with normals"));

  PointCloud with_nan = cloud;
  with_nan.points(1, 41) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(FailureOf(with_nan), HasSubstr("point 42 of 500 is not finite"));

  PointCloud in_one_place = cloud;
  in_one_place.points.colwise() = Eigen::Vector3d(1, 2, 3);
  EXPECT_THAT(FailureOf(in_one_place), HasSubstr("all points coincide"));
}

}  // namespace
}  // namespace lacuna
