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

}  // namespace
}  // namespace lacuna
