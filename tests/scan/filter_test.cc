#include "scan/filter.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "core/parallel.h"
#include "geometry/nearest.h"
#include "scan/test_files.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

// Points on `mesh` with noise along the normal, together with the exact normals.
PointCloud Sample(const TriMesh& mesh, int count, double noise) {
  PointCloud cloud = EvaluateSamples(mesh, SampleSurface(mesh, count, 3));
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0, noise);
  for (Eigen::Index i = 0; i < cloud.Size(); ++i) {
    cloud.points.col(i) += normal(random) * cloud.normals.col(i);
  }
  return cloud;
}

// The fraction of normals on the wrong side of the surface that the points were taken from.
double WrongFraction(const TriMesh& mesh, const PointCloud& cloud) {
  const SurfaceHits hits = SurfaceSearch(mesh).Nearest(cloud.points);
  const Eigen::Matrix3Xd truth = TriangleNormals(mesh)(Eigen::all, hits.triangle);
  // At an edge the estimated normal is a mean of both faces and may be at a right angle to one.
  return (truth.cwiseProduct(cloud.normals).colwise().sum().array() < -0.5).cast<double>().mean();
}

FilterOptions OnlyNormals() {
  FilterOptions options;
  options.outlier_neighbours = 0;
  return options;
}

PointCloud WithoutNormals(const PointCloud& cloud) {
  return {cloud.points, Eigen::Matrix3Xd(3, 0)};
}

TEST(Filter, RemovesTheOutliersAndKeepsTheSurface) {
  const TriMesh mesh = OrganicSurface(3);
  PointCloud cloud = WithoutNormals(Sample(mesh, 5000, 0.002));
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-3, 3);
  Eigen::Matrix3Xd outliers(3, 200);
  for (double& x : outliers.reshaped()) x = uniform(random);
  cloud.points.conservativeResize(3, 5200);
  cloud.points.rightCols(200) = outliers;
  const FilterResult result = FilterCloud(cloud, {}, {});
  const SurfaceSearch surface(mesh);
  const Eigen::VectorXd before = surface.Nearest(cloud.points).distance;
  const Eigen::VectorXd after = surface.Nearest(result.cloud.points).distance;
  const auto far = [](const Eigen::VectorXd& d) { return (d.array() > 0.2).count(); };
  ASSERT_GT(far(before), 150);
  EXPECT_LE(far(after), far(before) / 10);  // some outliers lie in pairs
  EXPECT_EQ(result.input_count, 5200);
  EXPECT_EQ(result.outlier_count + result.cloud.Size() + result.degenerate_count, 5200);
  EXPECT_GT(result.cloud.Size(), 4950);
}

TEST(Filter, LeavesOneMeanPointPerVoxel) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> uniform(0, 10);
  Eigen::Matrix3Xd points(3, 50'000);
  for (double& x : points.reshaped()) x = uniform(random);
  FilterOptions options = OnlyNormals();
  options.voxel_size = 1;
  const FilterResult result = FilterCloud({points, Eigen::Matrix3Xd(3, 0)}, {}, options);
  // Ten cubes along each side, or eleven when the grid begins inside the first.
  EXPECT_GE(result.cloud.Size(), 1000);
  EXPECT_LE(result.cloud.Size(), 1331);
  EXPECT_EQ(result.merged_count, 50'000 - result.cloud.Size() - result.degenerate_count);
  // The mean of some 50 points lies near the middle of its cube.
  const Eigen::MatrixXd distance =
      PointSearch(result.cloud.points).Nearest(result.cloud.points, 2).distance;
  EXPECT_GT(distance.row(1).mean(), 0.7);
}

TEST(Filter, EstimatesNormalsOfASphereOutward) {
  const TriMesh sphere = Icosphere(0.05, 4);
  const PointCloud cloud = Sample(sphere, 4000, 1e-4);
  const FilterResult result = FilterCloud(WithoutNormals(cloud), {}, OnlyNormals());
  const Eigen::VectorXd cosine =
      (result.cloud.points.colwise().normalized().cwiseProduct(result.cloud.normals))
          .colwise()
          .sum();
  EXPECT_GT(cosine.minCoeff(), 0.97);  // noise 0.1 mm over a neighbourhood of 4 mm: some 3°
  EXPECT_EQ(result.orientation.method, OrientationMethod::kPropagation);
  EXPECT_EQ(result.orientation.component_count, 1);
  EXPECT_EQ(result.orientation.doubtful_component_count, 0);
  EXPECT_EQ(result.orientation.disagreement, 0);
}

TEST(Filter, OrientsAroundSharpEdgesAndAcrossThinPlates) {
  for (const auto& [size, noise] : std::vector<std::pair<Eigen::Vector3d, double>>{
           {{0.1, 0.03, 0.03}, 0}, {{0.1, 0.03, 0.03}, 2e-4}, {{0.1, 0.06, 0.006}, 1e-4}}) {
    const TriMesh box = BoxSurface(size, {1, 1, 1});
    const FilterResult result =
        FilterCloud(WithoutNormals(Sample(box, 8000, noise)), {}, OnlyNormals());
    EXPECT_LT(WrongFraction(box, result.cloud), 2e-3) << size.transpose() << " noise " << noise;
  }
}

TEST(Filter, OrientsABodyWithHollows) {
  const TriMesh mesh = OrganicSurface(4);
  const FilterResult result =
      FilterCloud(WithoutNormals(Sample(mesh, 6000, 0.003)), {}, OnlyNormals());
  EXPECT_LT(WrongFraction(mesh, result.cloud), 1e-3);
}

TEST(Filter, OrientsAnOpenSheetTowardsItsSensor) {
  const TriMesh sheet = FlatSheet(0.1, 0.05, 1, 1);  // normals along +z
  const PointCloud cloud = WithoutNormals(Sample(sheet, 1500, 1e-4));
  for (const double side : {1.0, -1.0}) {
    Sensors sensors;
    sensors.positions = Eigen::Vector3d(0.02, 0.01, side);
    const FilterResult result = FilterCloud(cloud, sensors, OnlyNormals());
    EXPECT_EQ(result.orientation.method, OrientationMethod::kSensorsAround);
    EXPECT_EQ(result.orientation.doubtful_component_count, 0);
    EXPECT_GT((side * result.cloud.normals.row(2)).minCoeff(), 0.9);
  }
  // Without a sensor, either side of a flat sheet may be outside, and the result says so.
  const FilterResult blind = FilterCloud(cloud, {}, OnlyNormals());
  EXPECT_EQ(blind.orientation.doubtful_component_count, 1);
}

TEST(Filter, FacesEachPointTowardsTheSensorThatSawIt) {
  const TriMesh plate = BoxSurface({0.1, 0.05, 0.001}, {1, 1, 1});
  PointCloud cloud = Sample(plate, 6000, 0);
  Sensors sensors;
  sensors.positions.resize(3, 2);
  sensors.positions << 0.05, 0.05, 0.02, 0.02, 1, -1;
  sensors.seen_by.resize(cloud.Size());
  std::vector<int> faces;
  for (int i = 0; i < cloud.Size(); ++i) {
    if (std::abs(cloud.normals(2, i)) < 0.5) continue;
    sensors.seen_by[i] = cloud.normals(2, i) > 0 ? 0 : 1;
    faces.push_back(i);
  }
  const PointCloud seen{cloud.points(Eigen::all, faces), Eigen::Matrix3Xd(3, 0)};
  const Eigen::Matrix3Xd truth = cloud.normals(Eigen::all, faces);
  sensors.seen_by = Eigen::VectorXi(sensors.seen_by(faces));
  // The plate is thinner than the spacing of the points, so points of both faces enter each normal.
  const FilterResult result = FilterCloud(seen, sensors, OnlyNormals());
  EXPECT_EQ(result.orientation.method, OrientationMethod::kSensorOfEachPoint);
  EXPECT_GT(truth.cwiseProduct(result.cloud.normals).colwise().sum().minCoeff(), 0.5);
  EXPECT_EQ(result.sensors.seen_by, sensors.seen_by);
}

TEST(Filter, KeepsGivenNormalsUnlessAsked) {
  const TriMesh sphere = Icosphere(0.05, 3);
  PointCloud cloud = Sample(sphere, 1000, 0);
  cloud.normals *= -1;  // inward, which no estimate would be
  FilterOptions options = OnlyNormals();
  const FilterResult kept = FilterCloud(cloud, {}, options);
  EXPECT_EQ(kept.orientation.method, OrientationMethod::kGiven);
  EXPECT_LT((kept.cloud.normals - cloud.normals).cwiseAbs().maxCoeff(), 1e-12);
  options.renew_normals = true;
  const FilterResult renewed = FilterCloud(cloud, {}, options);
  EXPECT_LT(renewed.cloud.normals.cwiseProduct(cloud.normals).colwise().sum().maxCoeff(), 0);
}

TEST(Filter, IsTheSameForOneThreadAndTwo) {
  const PointCloud cloud = WithoutNormals(Sample(OrganicSurface(3), 3000, 0.01));
  FilterOptions options;
  options.voxel_size = 0.05;
  const int threads = ThreadCount();
  SetThreadCount(1);
  const FilterResult one = FilterCloud(cloud, {}, options);
  SetThreadCount(2);
  const FilterResult two = FilterCloud(cloud, {}, options);
  SetThreadCount(threads);
  EXPECT_EQ(one.cloud.points, two.cloud.points);
  EXPECT_EQ(one.cloud.normals, two.cloud.normals);
}

TEST(Filter, KeepsItsPrecisionFarFromTheOrigin) {
  const PointCloud near = WithoutNormals(Sample(Icosphere(0.05, 3), 2000, 1e-4));
  PointCloud far = near;
  const Eigen::Vector3d shift(1000, -2000, 500);
  far.points.colwise() += shift;
  FilterOptions options;
  options.voxel_size = 0.004;
  const FilterResult a = FilterCloud(near, {}, options), b = FilterCloud(far, {}, options);
  ASSERT_EQ(a.cloud.Size(), b.cloud.Size());
  // Doubles at 2 km are exact to 2e-13 m; single precision about the centre of a 0.1 m cloud adds
  // some 1e-8 m. Without the centring the error would be 1e-4 m.
  EXPECT_LT(((b.cloud.points.colwise() - shift) - a.cloud.points).cwiseAbs().maxCoeff(), 5e-8);
}

TEST(Filter, RefusesCloudsThatItCannotUse) {
  const PointCloud few{Eigen::Matrix3Xd::Random(3, 3), Eigen::Matrix3Xd(3, 0)};
  EXPECT_THAT(ErrorOf([&] { FilterCloud(few, {}, {}); }), HasSubstr("3 of 3 points are left"));
  const PointCloud wide{1e3 * Eigen::Matrix3Xd::Random(3, 100), Eigen::Matrix3Xd(3, 0)};
  FilterOptions options = OnlyNormals();
  options.voxel_size = 1e-3;
  EXPECT_THAT(ErrorOf([&] { FilterCloud(wide, {}, options); }), HasSubstr("choose a larger one"));
}

}  // namespace
}  // namespace lacuna
