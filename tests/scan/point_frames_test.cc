#include "scan/point_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/recording_fixture.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

TEST_F(RecordingTest, DropsNanRowsAndTheirTrianglesAndCountsThem) {
  folder_.Write("f/p0.csv", "x,y,z\n0,0,0\n10,0,0\n0,10,0\n0,0,10\n9,9,9\n");
  folder_.Write("f/p1.csv", "x,y,z\n0,0,0\nnan,nan,nan\n0,10,0\n0,0,10\n9,9,9\n");
  folder_.Write("triangles.csv", "i,j,k\n0,1,2\n0,2,3\n2,3,4\n");
  const Recording recording =
      Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz, triangles: triangles.csv}\n"));
  const Frame frame = LoadFrame(recording, 1);
  EXPECT_EQ(frame.row_count, 5);
  EXPECT_EQ(frame.dropped_count, 1);
  EXPECT_EQ(frame.cloud.Size(), 4);
  EXPECT_EQ(frame.source_row, Eigen::Vector4i(0, 2, 3, 4));
  ASSERT_EQ(frame.triangles.cols(), 2);
  EXPECT_EQ(frame.triangles.col(1), Eigen::Vector3i(1, 2, 3));
  EXPECT_THAT(DescribeRecording(recording), HasSubstr("1 of 5 dropped"));
}

TEST_F(RecordingTest, PointFramesReadNormalsSensorsAndColumns) {
  const std::string row = "9,1,0,0,0,0,2\n9,2,0,0,0,0,2\n9,2,3,0,0,0,2\n9,2,3,4,0,0,2\n";
  folder_.Write("p.csv", "id,a,b,c,na,nb,nc\n" + row);
  const Recording recording = Load(Yaml(
      "  kind: points\n  files: [p.csv]\n  columns: {x: a, y: b, z: c, nx: na, ny: nb, nz: nc}\n"
      "  sensors: [{position: [0, 0, 1 m]}]\n"
      "  transform: {axis: [1, 0, 0], angle: 90 deg}\n"));
  const Frame frame = LoadFrame(recording, 0);
  EXPECT_LT((frame.cloud.points.col(3) - 1e-3 * Eigen::Vector3d(2, -4, 3)).norm(), 1e-12);
  ASSERT_TRUE(frame.cloud.HasNormals());
  EXPECT_LT((frame.cloud.normals.col(0) - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
  EXPECT_EQ(frame.sensors.positions, Eigen::Matrix3Xd(Eigen::Vector3d(0, 0, 1)));
  EXPECT_TRUE(IsScan(recording));
  EXPECT_FALSE(HasTrackedPoints(recording));
}

TEST_F(RecordingTest, NotesThatAZeroNormalDiscardsAllGivenOnes) {
  folder_.Write("p.csv", "x,y,z,nx,ny,nz\n" + std::string("0,0,0,0,0,1\n9,0,0,0,0,0\n") +
                             "0,9,0,0,0,1\n9,9,1,0,0,1\n");
  const Recording recording = Load(Yaml("  {kind: points, files: [p.csv]}\n"));
  EXPECT_FALSE(LoadFrame(recording, 0).cloud.HasNormals());
  EXPECT_THAT(recording.warnings,
              testing::Contains(HasSubstr("p.csv: 1 of 4 normals are zero, so none of the "
                                          "given normals is used: all are estimated")));
  // Tracked points get no normals.
  const Frame tracked =
      LoadFrame(Load(Yaml("  {kind: points, files: [p.csv], tracked: true}\n")), 0);
  EXPECT_FALSE(tracked.cloud.HasNormals());
  EXPECT_THAT(tracked.notes,
              testing::ElementsAre(testing::EndsWith("of the given normals is used")));
}

TEST_F(RecordingTest, APointWithoutAFiniteNormalStays) {
  folder_.Write("p.csv", "x,y,z,nx,ny,nz\n" + std::string("0,0,0,0,0,1\n9,0,0,nan,nan,nan\n") +
                             "0,9,0,0,0,1\n9,9,1,0,0,1\n");
  const Frame frame = LoadFrame(Load(Yaml("  {kind: points, files: [p.csv]}\n")), 0);
  EXPECT_EQ(frame.cloud.Size(), 4);
  EXPECT_FALSE(frame.cloud.HasNormals());
}

// The lines of a table in which `zeros` of the points are (0, 0, 0).
std::string WithZeros(int points, int zeros) {
  std::string text = "x,y,z\n" + Cloud(points, 200);
  for (int i = 0; i < zeros; ++i) text += "0,0,0\n";
  return text;
}

TEST_F(RecordingTest, DropsPointsThatRepeatExactlyAndCountsThem) {
  folder_.Write("a.csv", WithZeros(40, 300) + "-1,-1,-1\n210,5,5\n210,5,5\n210,5,5\n");
  const Recording recording = Load(Yaml("  {kind: points, files: [a.csv]}\n"));
  const Frame frame = LoadFrame(recording, 0);
  EXPECT_EQ(frame.repeated_count, 302) << "all zeros, and two of three equal points";
  EXPECT_EQ(frame.cloud.Size(), 42);
  EXPECT_THAT(recording.warnings,
              testing::ElementsAre(HasSubstr("frame 0: 302 of 344 points repeat exactly")));
  EXPECT_THAT(DescribeRecording(recording), HasSubstr("302 of 344 dropped (302 repeat exactly)"));
  // A transform moves the zeros; they are recognised as they are in the file.
  const Recording moved =
      Load(Yaml("  {kind: points, files: [a.csv], transform: {translation: [1 m, 0, 0]}}\n"));
  EXPECT_EQ(LoadFrame(moved, 0).repeated_count, 302);
}

TEST_F(RecordingTest, ASinglePointAtTheOriginStays) {
  folder_.Write("a.csv", WithZeros(40, 1));
  EXPECT_EQ(LoadFrame(Load(Yaml("  {kind: points, files: [a.csv]}\n")), 0).cloud.Size(), 41);
}

TEST_F(RecordingTest, OfTrackedPointsThoseAtZeroWereNotSeen) {
  folder_.Write("a.csv", WithZeros(10, 3) + "210,5,5\n210,5,5\n");
  const Frame frame = LoadFrame(Load(Yaml("  {kind: points, files: [a.csv], tracked: true}\n")), 0);
  EXPECT_EQ(frame.repeated_count, 3) << "two material points may meet";
  EXPECT_EQ(frame.source_row[10], 13);
}

TEST_F(RecordingTest, AFrameOfNothingButZerosSaysSo) {
  folder_.Write("a.csv", WithZeros(2, 0).substr(0, 6) + "0,0,0\n0,0,0\n0,0,0\n0,0,0\n");
  EXPECT_THAT(LoadError(Yaml("  {kind: points, files: [a.csv]}\n")),
              HasSubstr("none of its 4 points is finite and measured: 4 repeat exactly"));
}

TEST_F(RecordingTest, ManyPointsOfAPlaceholderAreDroppedInSeconds) {
  std::string text = "x,y,z\n" + Cloud(300, 50);
  for (int i = 0; i < 200'000; ++i) text += "0,0,-5\n";
  folder_.Write("a.csv", text);
  EXPECT_EQ(LoadFrame(Load(Yaml("  {kind: points, files: [a.csv]}\n")), 0).cloud.Size(), 300);
}

TEST_F(RecordingTest, CropKeepsWhatLiesInARegionOfTheWorld) {
  folder_.Write("a.csv", "x,y,z\n" + Cloud(101));  // x from 0 to 100 mm in steps of 1 mm
  const auto count = [this](const std::string& crop) {
    const Frame frame =
        LoadFrame(Load(Yaml("  kind: points\n  files: [a.csv]\n  transform: {translation: [1 m, 0, "
                            "0]}\n  crop: {" +
                            crop + "}\n")),
                  0);
    EXPECT_EQ(frame.cropped_count + frame.cloud.Size(), 101);
    return frame.cloud.Size();
  };
  EXPECT_EQ(count("half_space: {point: [1.0905 m, 0, 0], normal: [1, 0, 0]}"), 10);
  EXPECT_EQ(count("box: {min: [1.0195 m, -1 m, -1 m], max: [1.0295 m, 1 m, 1 m]}"), 10);
  EXPECT_EQ(count("sphere: {center: [1 m, 0, 0], radius: 3 m}"), 101);
  EXPECT_THAT(LoadError(Yaml("  {kind: points, files: [a.csv], crop: {nodes: [1]}}\n")),
              HasSubstr("frames.crop: expected box, sphere or half_space"));
  EXPECT_THAT(LoadError(Yaml("  kind: points\n  files: [a.csv]\n  crop: {sphere: {center: [9 m, 0, "
                             "0], radius: 1 mm}}\n")),
              HasSubstr("none of its 101 points is finite; 101 lie outside the crop"));
}

TEST_F(RecordingTest, KeepsTheLargestComponentOfACloud) {
  std::string text = "x,y,z\n" + Cloud(200);
  for (int i = 0; i < 6; ++i) text += std::to_string(300 + i) + ",0,0\n";
  folder_.Write("a.csv", text);
  EXPECT_EQ(LoadFrame(Load(Yaml("  {kind: points, files: [a.csv]}\n")), 0).cloud.Size(), 206);
  const Frame frame =
      LoadFrame(Load(Yaml("  {kind: points, files: [a.csv], keep_largest: true}\n")), 0);
  EXPECT_EQ(frame.separate_count, 6);
  EXPECT_EQ(frame.cloud.Size(), 200);
}

}  // namespace
}  // namespace lacuna
