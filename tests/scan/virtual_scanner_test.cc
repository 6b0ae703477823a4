#include "scan/virtual_scanner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "core/parallel.h"
#include "geometry/nearest.h"
#include "scan/recording.h"
#include "scan/recording_writer.h"
#include "scan/scan_writer.h"
#include "scan/test_files.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

ScannerOptions Perfect() {
  ScannerOptions options;
  options.noise = 0;
  options.quantum = 0;
  options.flying_fraction = 0;
  options.dropout = 0;
  return options;
}

CameraRing RingAround(const Eigen::Vector3d& center) {
  CameraRing ring;
  ring.center = center;
  ring.width = 160;
  ring.height = 120;
  return ring;
}

TEST(VirtualScanner, SeesTheSurfaceExactlyWithoutNoise) {
  const TriMesh mesh = OrganicSurface(3);
  CameraRing ring = RingAround({0, 0.5, 0});
  ring.radius = 8;
  const ScanResult scan = Scan(mesh, PlaceCameras(ring), Perfect(), 0);
  ASSERT_GT(scan.cloud.Size(), 5000);
  EXPECT_LT(SurfaceSearch(mesh).Nearest(scan.cloud.points).distance.maxCoeff(), 1e-12);
}

TEST(VirtualScanner, SeesOnlyWhatNothingHides) {
  const TriMesh sphere = Icosphere(0.1, 4);
  VirtualCamera camera = PlaceCameras(RingAround(Eigen::Vector3d::Zero()))[0];
  const Eigen::Vector3d eye = camera.camera.world_from_camera.translation();
  ScannerOptions options = Perfect();
  options.max_incidence = 1.57;
  const ScanResult scan = Scan(sphere, {camera}, options, 0);
  // The visible cap ends where rays are tangent to the sphere, n·eye = r; facets add a little.
  const Eigen::VectorXd along = (scan.cloud.points.transpose() * eye.normalized()) / 0.1;
  EXPECT_GT(along.minCoeff(), 0.1 / eye.norm() - 0.02);
  EXPECT_LT(along.minCoeff(), 0.1 / eye.norm() + 0.05);
  // Every pixel inside the outline is covered: there are no gaps along shared edges.
  const RenderedView view = Render(sphere, camera);
  for (Eigen::Index v = 0; v < view.depth.rows(); ++v) {
    Eigen::Index first = -1, last = -1, seen = 0;
    for (Eigen::Index u = 0; u < view.depth.cols(); ++u) {
      if (view.depth(v, u) == 0) continue;
      if (first < 0) first = u;
      last = u;
      ++seen;
    }
    if (seen > 0) {
      EXPECT_EQ(seen, last - first + 1) << "row " << v;
    }
  }
}

TEST(VirtualScanner, NoiseHasTheDeviationAskedForAndGrowsWithRange) {
  const TriMesh plate = BoxSurface({0.4, 0.4, 0.01}, {1, 1, 1});
  VirtualCamera camera;
  camera.width = camera.height = 200;
  camera.camera.intrinsics = {1000, 1000, 99.5, 99.5};
  ScannerOptions options = Perfect();
  options.noise = 3e-4;
  options.noise_growth = 2;
  options.reference_range = 0.5;
  for (const double range : {0.5, 1.0}) {
    camera.camera.world_from_camera = Eigen::Translation3d(0.2, 0.2, 0.01 + range) *
                                      Eigen::AngleAxisd(std::numbers::pi, Eigen::Vector3d::UnitX());
    const ScanResult scan = Scan(plate, {camera}, options, 0);
    ASSERT_EQ(scan.cloud.Size(), 40'000);
    const Eigen::ArrayXd error = scan.cloud.points.row(2).transpose().array() - 0.01;
    const double expected = 3e-4 * std::pow(range / 0.5, 2);
    // Standard errors for 40 000 values: 0.5 % of σ for the mean, 0.35 % for σ; the rays are up to
    // 8° oblique, which changes range and component by less than 2 %.
    EXPECT_NEAR(error.mean(), 0, 0.02 * expected);
    EXPECT_NEAR(std::sqrt(error.square().mean()), expected, 0.03 * expected);
  }
}

TEST(VirtualScanner, QuantisesAndDropsOut) {
  const TriMesh plate = BoxSurface({0.4, 0.4, 0.01}, {1, 1, 1});
  VirtualCamera camera;
  camera.width = camera.height = 100;
  camera.camera.intrinsics = {500, 500, 49.5, 49.5};
  camera.camera.world_from_camera =
      Eigen::Translation3d(0.2, 0.2, 0.51) * Eigen::AngleAxisd(3.0, Eigen::Vector3d::UnitX());
  ScannerOptions options = Perfect();
  options.quantum = 1e-3;
  options.dropout = 0.2;
  const DepthImage depth = Measure(Render(plate, camera), camera, options, 0, 0);
  int seen = 0;
  for (const double d : depth.reshaped()) {
    if (d == 0) continue;
    ++seen;
    EXPECT_NEAR(d, 1e-3 * std::round(d / 1e-3), 1e-12);
  }
  EXPECT_NEAR(seen, 8000, 160);  // four standard errors of a binomial count
}

TEST(VirtualScanner, PixelsFlyOnlyAtEdgesAndOnlyBackwards) {
  const TriMesh sphere = Icosphere(0.1, 4);
  const VirtualCamera camera = PlaceCameras(RingAround(Eigen::Vector3d::Zero()))[1];
  ScannerOptions options = Perfect();
  options.flying_fraction = 0.5;
  options.flying_reach = 0.02;
  options.max_incidence = 1.57;
  const RenderedView view = Render(sphere, camera);
  const DepthImage depth = Measure(view, camera, options, 0, 0);
  int flying = 0;
  for (Eigen::Index v = 1; v + 1 < depth.rows(); ++v) {
    for (Eigen::Index u = 1; u + 1 < depth.cols(); ++u) {
      const double change = depth(v, u) - view.depth(v, u);
      if (depth(v, u) == 0 || change == 0) continue;
      ++flying;
      EXPECT_GT(change, 0);
      EXPECT_LE(change, 0.02);
      bool at_edge = false;
      for (const double other : {view.depth(v - 1, u), view.depth(v + 1, u), view.depth(v, u - 1),
                                 view.depth(v, u + 1)}) {
        at_edge |= other == 0 || other > view.depth(v, u) + options.edge_jump;
      }
      EXPECT_TRUE(at_edge);
    }
  }
  EXPECT_GT(flying, 20);
}

TEST(VirtualScanner, DependsOnTheSeedAndNotOnThreads) {
  const TriMesh mesh = Icosphere(0.1, 3);
  const std::vector<VirtualCamera> cameras = PlaceCameras(RingAround(Eigen::Vector3d::Zero()));
  ScannerOptions options;
  const int threads = ThreadCount();
  SetThreadCount(1);
  const ScanResult one = Scan(mesh, cameras, options, 0);
  SetThreadCount(2);
  const ScanResult two = Scan(mesh, cameras, options, 0);
  SetThreadCount(threads);
  EXPECT_EQ(one.cloud.points, two.cloud.points);
  EXPECT_EQ(one.sensors.seen_by, two.sensors.seen_by);
  const ScanResult later = Scan(mesh, cameras, options, 1);
  options.seed = 2;
  const ScanResult other = Scan(mesh, cameras, options, 0);
  const auto differs = [&](const ScanResult& scan) {
    return scan.cloud.Size() != one.cloud.Size() || scan.cloud.points != one.cloud.points;
  };
  EXPECT_TRUE(differs(later));
  EXPECT_TRUE(differs(other));
}

TEST(VirtualScanner, ShufflesItsPoints) {
  const std::vector<VirtualCamera> cameras = PlaceCameras(RingAround(Eigen::Vector3d::Zero()));
  const ScanResult scan = Scan(Icosphere(0.1, 3), cameras, Perfect(), 0);
  // In the order of rendering the camera changes three times; after shuffling, at three of four
  // points.
  int changes = 0;
  for (Eigen::Index i = 1; i < scan.cloud.Size(); ++i) {
    changes += scan.sensors.seen_by[i] != scan.sensors.seen_by[i - 1];
  }
  EXPECT_NEAR(1.0 * changes / static_cast<double>(scan.cloud.Size()), 0.75, 0.03);
}

TEST(VirtualScanner, RefusesACameraInsideTheObject) {
  CameraRing ring = RingAround(Eigen::Vector3d::Zero());
  ring.radius = 0.05;
  EXPECT_THAT(ErrorOf([&] { Scan(Icosphere(0.1, 2), PlaceCameras(ring), Perfect(), 0); }),
              HasSubstr("reaches up to camera 1 or behind it"));
}

class ScanWriter : public testing::TestWithParam<FrameWriter> {};

TEST_P(ScanWriter, WritesAnOrdinaryRecording) {
  const TestFolder folder;
  const TriMesh first = BoxSurface({0.1, 0.03, 0.03}, {4, 2, 2});
  TriMesh second = first;
  second.vertices.colwise() += Eigen::Vector3d(0, 0, 0.01);
  RecordedObject object;
  object.density = 1070;
  object.gravity = Eigen::Vector3d(0, 0, -9.81);
  object.fixed = {{"clamp", HalfSpaceRegion{{0, 0, 0}, {-1, 0, 0}}}};
  RecordedGrip grip;
  grip.region = {"end", HalfSpaceRegion{{0.1, 0, 0}, {1, 0, 0}}};
  grip.motion = GripMotion::kGiven;
  grip.times = Eigen::Vector2d(0, 0.25);
  grip.displacements = (Eigen::Matrix3Xd(3, 2) << 0, 0, 0, 0, 0, 0.01).finished();
  object.grips = {grip};
  ScannerOptions options;
  options.noise = 1e-4;
  options.flying_fraction = 0;
  const std::vector<VirtualCamera> cameras = PlaceCameras(RingAround({0.05, 0.015, 0.015}));
  WriteScan(folder.Path(), "bar", object, {{first, second}, {0, 0.25}, cameras, options},
            GetParam());
  EXPECT_TRUE(IsSimulatedRecording(folder.Path()));

  const Recording recording = LoadRecording(folder.Path());
  EXPECT_EQ(recording.name, "bar");
  EXPECT_EQ(recording.object.density, 1070);
  EXPECT_EQ(*recording.object.gravity, Eigen::Vector3d(0, 0, -9.81));
  ASSERT_EQ(recording.FrameCount(), 2);
  EXPECT_EQ(recording.times[1], 0.25);
  ASSERT_EQ(recording.object.fixed.size(), 1u);
  ASSERT_EQ(recording.object.grips.size(), 1u);
  EXPECT_LT(
      (MotionAt(recording.object.grips[0], 0.125).translation() - Eigen::Vector3d(0, 0, 0.005))
          .norm(),
      1e-15);
  EXPECT_TRUE(recording.warnings.empty());
  for (int i = 0; i < 2; ++i) {
    const Frame frame = LoadFrame(recording, i);
    EXPECT_GT(frame.cloud.Size(), 1000);
    EXPECT_EQ(frame.sensors.positions.cols(), 4);
    EXPECT_EQ(frame.sensors.seen_by.size(),
              GetParam() == WriteDepthFrames ? frame.cloud.Size() : 0);
    const TriMesh truth = ReadTrueSurface(folder.Path(), i);
    EXPECT_EQ(truth.triangles, first.triangles);
    EXPECT_EQ(truth.vertices, i == 0 ? first.vertices : second.vertices);
    const Eigen::VectorXd distance = SurfaceSearch(truth).Nearest(frame.cloud.points).distance;
    // Noise of 0.1 mm and rounding to 0.1 mm: five deviations and half a step.
    EXPECT_LT(distance.maxCoeff(), 5e-4 + 0.5e-4);
    EXPECT_GT(distance.mean(), 2e-5);
  }
}
INSTANTIATE_TEST_SUITE_P(Outputs, ScanWriter, testing::Values(WritePointFrames, WriteDepthFrames));

TEST(ScanWriter, RefusesDepthsThatDoNotFit) {
  const TestFolder folder;
  const std::vector<VirtualCamera> cameras = PlaceCameras(RingAround(Eigen::Vector3d::Zero()));
  ScannerOptions options;
  options.quantum = 1e-6;
  const auto write = [&] {
    WriteScan(folder.Path(), "", {}, {{Icosphere(0.1, 2)}, {0}, cameras, options},
              WriteDepthFrames);
  };
  EXPECT_THAT(ErrorOf(write), HasSubstr("does not fit in 16 bits"));
  EXPECT_FALSE(std::filesystem::exists(folder.Path() / "recording.yaml"));
  options.quantum = 0;
  EXPECT_THAT(ErrorOf(write), HasSubstr("need a quantum > 0"));
}

}  // namespace
}  // namespace lacuna
