#include "scan/camera_alignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/nearest.h"
#include "scan/recording.h"
#include "scan/scan_writer.h"
#include "scan/test_files.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

struct Views {
  std::vector<Eigen::Matrix3Xd> clouds;
  Eigen::Matrix3Xd positions;
};

TriMesh Body() {
  TriMesh mesh = OrganicSurface(4);
  mesh.vertices *= 0.05;
  return mesh;
}

std::vector<VirtualCamera> Cameras(int count) {
  CameraRing ring;
  ring.count = count;
  ring.width = 160, ring.height = 120;
  ring.center = Body().vertices.rowwise().mean();
  return PlaceCameras(ring);
}

ScannerOptions Noise() {
  ScannerOptions options;
  options.flying_fraction = 0;
  options.noise = 1e-4;
  return options;
}

Views Scanned(int count) {
  const ScanResult scan = Scan(Body(), Cameras(count), Noise(), 0);
  Views views{std::vector<Eigen::Matrix3Xd>(count), scan.sensors.positions};
  for (int c = 0; c < count; ++c) {
    std::vector<Eigen::Index> own;
    for (Eigen::Index i = 0; i < scan.cloud.Size(); ++i) {
      if (scan.sensors.seen_by[i] == c) own.push_back(i);
    }
    views.clouds[c] = scan.cloud.points(Eigen::all, own);
  }
  return views;
}

Eigen::Isometry3d Disturbance(int i) {
  const Eigen::Vector3d axis = Eigen::Vector3d(1, -i, 0.5 * i).normalized();
  return Eigen::Translation3d(1e-3 * i, -1e-3, 0.5e-3) * Eigen::AngleAxisd(0.01 * i, axis);
}

TEST(CameraAlignment, RemovesADisturbanceOfThePoses) {
  Views views = Scanned(6);
  const Views exact = views;
  for (int i = 1; i < 6; ++i) {
    views.clouds[i] = (Disturbance(i) * views.clouds[i]).eval();
    views.positions.col(i) = Disturbance(i) * views.positions.col(i);
  }
  const auto corrections = AlignCameras(views.clouds, views.positions, {});
  for (int i = 1; i < 6; ++i) {
    ASSERT_TRUE(corrections[i].applied) << corrections[i].message;
    const Eigen::Matrix3Xd aligned = corrections[i].correction * views.clouds[i];
    const double before = (views.clouds[i] - exact.clouds[i]).colwise().norm().mean();
    const double after = (aligned - exact.clouds[i]).colwise().norm().mean();
    ASSERT_GT(before, 1e-3);
    // A smooth body easily slides along itself, which amplifies noise of 0.1 mm to some 0.3 mm.
    EXPECT_LT(after, 4e-4) << "camera " << i;
    EXPECT_LT(after, before / 4) << "camera " << i;
    EXPECT_LT(corrections[i].rms_after, 0.5 * corrections[i].rms_before);
    EXPECT_GT(corrections[i].angle, 0.005);
  }
}

TEST(CameraAlignment, LeavesGoodPosesNearlyAsTheyAre) {
  const Views views = Scanned(6);
  AlignmentOptions options;
  options.sweeps = 2;
  const auto corrections = AlignCameras(views.clouds, views.positions, options);
  for (int i = 1; i < 6; ++i) {
    const Eigen::Matrix3Xd moved = corrections[i].correction * views.clouds[i];
    EXPECT_LT((moved - views.clouds[i]).colwise().norm().mean(), 4e-4);  // as above
  }
}

TEST(CameraAlignment, LeavesMotionsUnchangedThatAPlaneDoesNotDetermine) {
  Views views;
  views.positions = (Eigen::Matrix3Xd(3, 2) << 0.1, 0.1, 0, 0.1, 1, 1).finished();
  for (const int seed : {1, 2}) {
    const TriMesh plane = FlatSheet(0.2, 0.1, 1, 1);
    views.clouds.push_back(EvaluateSamples(plane, SampleSurface(plane, 3000, seed)).points);
  }
  views.clouds[1].colwise() += Eigen::Vector3d(0.002, 0.001, 0.003);
  const CameraCorrection correction = AlignCameras(views.clouds, views.positions, {})[1];
  ASSERT_TRUE(correction.applied);
  EXPECT_EQ(correction.free_directions, 3);  // two translations and one rotation
  // The offset across the plane is determined up to single precision, that along it not at all.
  EXPECT_NEAR(correction.correction.translation().z(), -0.003, 1e-7);
  EXPECT_LT(correction.correction.translation().head<2>().norm(), 1e-6);
  EXPECT_LT(correction.angle, 1e-6);
}

TEST(CameraAlignment, SaysWhyItDidNothing) {
  Views views = Scanned(2);
  views.clouds[1].colwise() += Eigen::Vector3d(1, 0, 0);
  const auto apart = AlignCameras(views.clouds, views.positions, {});
  EXPECT_FALSE(apart[1].applied);
  EXPECT_THAT(apart[1].message, HasSubstr("not applied: 0 pairs overlap"));
  EXPECT_TRUE(apart[1].correction.isApprox(Eigen::Isometry3d::Identity()));
  EXPECT_EQ(apart[1].rms_before, -1);
  views.clouds[1].resize(3, 2);
  EXPECT_THAT(AlignCameras(views.clouds, views.positions, {})[1].message,
              HasSubstr("sees too few points"));
}

TEST(CameraAlignment, IsAppliedToADepthRecordingAndReported) {
  const TestFolder folder;
  std::vector<VirtualCamera> cameras = Cameras(6);
  const std::filesystem::path exact_folder = folder / "exact", wrong_folder = folder / "wrong";
  WriteScan(exact_folder, "body", {}, {{Body()}, {0}, cameras, Noise()}, WriteDepthFrames);
  // The images belong to the true poses; recording.yaml gives wrong ones.
  for (int i = 1; i < 6; ++i) {
    Eigen::Isometry3d& pose = cameras[i].camera.world_from_camera;
    pose = Disturbance(i) * pose;
  }
  WriteScan(wrong_folder, "body", {}, {{Body()}, {0}, cameras, Noise()}, WriteDepthFrames);
  std::filesystem::remove_all(wrong_folder / "frames");
  std::filesystem::copy(exact_folder / "frames", wrong_folder / "frames");
  const auto error = [](const Recording& recording) {
    return SurfaceSearch(Body()).Nearest(LoadFrame(recording, 0).cloud.points).distance.mean();
  };
  const double exact = error(LoadRecording(exact_folder));
  const double wrong = error(LoadRecording(wrong_folder));
  std::string yaml = FileContent(wrong_folder / "recording.yaml");
  yaml.insert(yaml.find("  kind: depth"), "  refine_alignment: {max_distance: 1 cm, sweeps: 3}\n");
  const Recording refined = LoadRecording(folder.Write("wrong/recording.yaml", yaml));
  ASSERT_GT(wrong, 4 * exact);
  EXPECT_LT(error(refined), 2 * exact);
  EXPECT_THAT(DescribeRecording(refined), HasSubstr("pose corrected by"));
}

}  // namespace
}  // namespace lacuna
