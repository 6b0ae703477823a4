#include "scan/depth_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/recording_fixture.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kPose =
    "world_from_camera: [1, 0, 0, 0,  0, 1, 0, 0,  0, 0, 1, 500,  0, 0, 0, 1]";

std::string Camera(const std::string& name, const std::string& files) {
  return "    - {name: " + name + ", files: " + files +
         ", intrinsics: {fx: 100, fy: 100, cx: 1, cy: 0}, " + kPose + "}\n";
}

std::string DepthYaml(const std::string& cameras, const std::string& more = "") {
  return Yaml("  kind: depth\n  depth_unit: 1 mm\n  rate: 10 Hz\n" + more + "  cameras:\n" +
              cameras);
}

class DepthFramesTest : public RecordingTest {
 protected:
  // Two rows of three pixels that measure `depth` (m), except for the last one.
  void WriteImage(const std::string& name, double depth) const {
    DepthImage image = DepthImage::Constant(2, 3, depth);
    image(1, 2) = 0;
    WriteDepthPng(folder_.Path() / name, image, 1e-3);
  }
};

TEST_F(DepthFramesTest, PutTogetherThePointsOfAllCameras) {
  WriteImage("a.png", 0.2);
  WriteImage("b.png", 0.4);
  const Recording recording =
      Load(DepthYaml(Camera("left", "[a.png]") + Camera("right", "[b.png]")));
  const Frame frame = LoadFrame(recording, 0);
  ASSERT_EQ(frame.cloud.Size(), 10);
  EXPECT_EQ(frame.row_count, 10) << "pixels without a measurement are no points";
  EXPECT_LT((frame.cloud.points.col(0) - Eigen::Vector3d(-0.002, 0, 0.7)).norm(), 1e-12);
  EXPECT_LT((frame.cloud.points.col(5) - Eigen::Vector3d(-0.004, 0, 0.9)).norm(), 1e-12);
  EXPECT_EQ(frame.sensors.seen_by.sum(), 5);
  EXPECT_THAT(DescribeRecording(recording), HasSubstr("camera       left at (0, 0, 0.5) m"));
  EXPECT_TRUE(IsScan(recording));
}

TEST_F(DepthFramesTest, DropDepthsOutOfRange) {
  WriteImage("a.png", 0.2);
  WriteImage("b.png", 0.4);
  const std::string cameras = Camera("left", "[a.png]") + Camera("right", "[b.png]");
  EXPECT_EQ(LoadFrame(Load(DepthYaml(cameras, "  max_depth: 0.3 m\n")), 0).dropped_count, 5);
  EXPECT_THAT(LoadError(DepthYaml(cameras, "  min_depth: 1 m\n")),
              HasSubstr("none of its 10 points lies within min_depth and max_depth"));
}

TEST_F(DepthFramesTest, RefuseCamerasWithDifferentNumbersOfFrames) {
  WriteImage("a.png", 0.2);
  EXPECT_THAT(LoadError(DepthYaml(Camera("left", "[a.png]") + Camera("right", "[a.png, a.png]"))),
              HasSubstr("cameras[1]: has 2 frames where the cameras before have 1"));
}

TEST_F(DepthFramesTest, RefuseAnImageOfAnotherSize) {
  WriteImage("a.png", 0.2);
  WriteImage("b.png", 0.2);
  WriteDepthPng(folder_.Path() / "c.png", DepthImage::Constant(3, 2, 0.2), 1e-3);
  const Recording recording = Load(DepthYaml(Camera("left", "[a.png, b.png, c.png]")));
  EXPECT_EQ(LoadFrame(recording, 1).cloud.Size(), 5);
  EXPECT_THAT(ErrorOf([&] { LoadFrame(recording, 2); }),
              HasSubstr("c.png: has 2 × 3 pixels where"));
}

TEST_F(DepthFramesTest, WarnOfASizeThatSuggestsAnotherDepthUnit) {
  WriteImage("a.png", 0.01);
  const Recording recording = Load(DepthYaml(Camera("left", "[a.png]")));
  EXPECT_THAT(recording.warnings, ElementsAre(HasSubstr("across; check depth_unit")));
}

TEST_F(DepthFramesTest, WarnOfASizeThatIsThatOfThePoses) {
  WriteImage("a.png", 0.2);
  std::string far = Camera("right", "[a.png]");
  far.replace(far.find("0, 1, 0, 0"), 10, "0, 1, 0, 9e5");
  const Recording recording = Load(DepthYaml(Camera("left", "[a.png]") + far));
  EXPECT_THAT(recording.warnings, testing::Contains(HasSubstr(
                                      "across; check length_unit, mm, in which the translations "
                                      "of the cameras are read: these are 900 m apart")));
}

TEST_F(DepthFramesTest, TellPosesThatAreTransposed) {
  WriteImage("a.png", 0.2);
  std::string camera = Camera("left", "[a.png]");
  camera.replace(camera.find("1, 500,  0, 0, 0, 1"), 19, "1, 0,  0, 0, 500, 1");
  EXPECT_THAT(LoadError(DepthYaml(camera)), HasSubstr("has its numbers column by column"));
}

}  // namespace
}  // namespace lacuna
