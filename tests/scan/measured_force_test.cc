#include "scan/measured_force.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/npy.h"
#include "scan/recording_fixture.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

TEST(ForceAt, IsLinearBetweenTheTimesAndConstantBeyond) {
  MeasuredForce force;
  force.times = Eigen::Vector2d(1, 3);
  force.forces.resize(3, 2);
  force.forces << 0, 4, 0, 0, 1, 1;
  EXPECT_EQ(ForceAt(force, 2), Eigen::Vector3d(2, 0, 1));
  EXPECT_EQ(ForceAt(force, 0), Eigen::Vector3d(0, 0, 1));
  EXPECT_EQ(ForceAt(force, 9), Eigen::Vector3d(4, 0, 1));
}

class ForcesOfRecording : public RecordingTest {
 protected:
  // What is wrong with a force that the rest of this YAML describes.
  std::string Error(const std::string& force) const {
    WriteClouds(2);
    return LoadError(
        Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n", "forces: [{" + force + "}]\n"));
  }
};

// Its force at any time would be read from outside of its memory.
TEST_F(ForcesOfRecording, MustHaveARow) {
  WriteNpy(folder_ / "none.npy", Eigen::MatrixXd(0, 4));
  EXPECT_THAT(Error("file: none.npy, time: \"1\", x: \"2\", y: \"3\", z: \"4\""),
              HasSubstr("none.npy has no rows"));
}

TEST_F(ForcesOfRecording, NameTheLineOfABadRow) {
  const std::string columns = ", time: t, x: x, y: y, z: z";
  folder_.Write("load.csv", "# a remark\nt,x,y,z\n\n,0,0,1\n1,0,inf,1\n");
  EXPECT_THAT(Error("file: load.csv" + columns), HasSubstr("load.csv:4: has no time"));
  folder_.Write("load.csv", "# a remark\nt,x,y,z\n1,0,0,1\n0.5,0,0,1\n");
  EXPECT_THAT(Error("file: load.csv" + columns),
              HasSubstr("load.csv:4: its time, 0.5 s, is before that of the row above"));
  folder_.Write("load.csv", "t,x,y,z\n0,0,,1\n");
  EXPECT_THAT(Error("file: load.csv" + columns), HasSubstr("load.csv has no row with a value"));
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2, 4);
  rows(0, 0) = 1;  // the time
  WriteNpy(folder_ / "load.npy", rows);
  EXPECT_THAT(Error("file: load.npy, time: \"1\", x: \"2\", y: \"3\", z: \"4\""),
              HasSubstr("load.npy: row 2: its time, 0 s, is before"));
}

TEST_F(ForcesOfRecording, LeaveOutMissingValuesAndAverageThoseOfEqualTimes) {
  folder_.Write("load.csv", "t,fx,fy,fz\n0,0,0,1\n0,0,0,2\n0,0,0,6\n0.5,0,NULL,1\n1,0,0,1\n");
  WriteClouds(2);
  const Recording recording = Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n",
                                        "forces: [{name: pull, file: load.csv, time: t}]\n"));
  const MeasuredForce& pull = recording.object.forces.at(0);
  EXPECT_EQ(pull.times, Eigen::Vector2d(0, 1));
  EXPECT_NEAR(pull.forces(2, 0), 3, 1e-15);
  EXPECT_THAT(DescribeForce(pull), HasSubstr("rows without a value, left out: 1, rows with the "
                                             "time of another, averaged: 2"));
}

// The times would be taken for the component x.
TEST_F(ForcesOfRecording, HaveTheirOwnColumns) {
  WriteClouds(2);
  folder_.Write("load.csv", "t,x,fx,fy,fz\n0,9,1,2,3\n1,9,1,2,3\n");
  const std::string frames = "  {kind: points, files: f/*.csv, rate: 1 Hz}\n";
  const Recording recording = Load(Yaml(frames, "forces: [{file: load.csv, time: t}]\n"));
  EXPECT_EQ(recording.object.forces.at(0).forces.col(0), Eigen::Vector3d(1, 2, 3));
  folder_.Write("load.csv", "t,F1,F2,F3\n0,1,2,3\n1,1,2,3\n");
  EXPECT_THAT(Error("file: load.csv, time: t"),
              HasSubstr("load.csv has no column \"x\"; say with"));
  EXPECT_THAT(Error("file: load.csv, time: t, x: t, y: F2, z: F3"), HasSubstr("is column 1 of"));
  folder_.Write("load.csv", "0,1,2,3\n1,1,2,3\n");
  EXPECT_THAT(Error("file: load.csv, time: '1'"), HasSubstr("from which values are also read"));
}

// As for a load cell: a machine measures one component.
TEST_F(ForcesOfRecording, MayHaveTheComponentsThatAreNamedAlone) {
  WriteClouds(2);
  folder_.Write("load.csv", "t,F,G\n0,4,1\n1,8,2\n");
  const auto force = [&](const std::string& keys) {
    const Recording recording = Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n",
                                          "forces: [{file: load.csv, time: t, " + keys + "}]\n"));
    return Eigen::Matrix3Xd(recording.object.forces.at(0).forces);
  };
  Eigen::Matrix<double, 3, 2> expected;
  expected << 0, 0, 0, 0, 4, 8;
  EXPECT_EQ(force("z: F"), expected);
  expected << 1e-3, 2e-3, 0, 0, 4e-3, 8e-3;
  EXPECT_TRUE(force("z: F, x: G, unit: mN").isApprox(expected, 1e-15));
  expected << 2.4, 4.8, -3.2, -6.4, 0, 0;
  EXPECT_TRUE(force("along: [3, -4, 0], value: F").isApprox(expected, 1e-15));
}

TEST_F(ForcesOfRecording, MayNotLeaveOpenWhichComponentsAreMeant) {
  folder_.Write("load.csv", "t,F,y\n0,4,1\n1,8,2\n");
  EXPECT_THAT(Error("file: load.csv, time: t, z: F"),
              HasSubstr("load.csv has a column \"y\", but `y` is not given"));
  folder_.Write("numbers.csv", "0,4,1\n1,8,2\n");
  EXPECT_THAT(Error("file: numbers.csv, time: 1, z: 2"),
              HasSubstr("columns without names do not tell whether the other components"));
  EXPECT_THAT(Error("file: load.csv, time: t, z: F, along: [0, 0, 1], value: F"),
              HasSubstr("forces[0].along: the components x, y, z already have columns"));
  EXPECT_THAT(Error("file: load.csv, time: t, along: [0, 0, 0], value: F"),
              HasSubstr("forces[0].along: expected a direction other than 0"));
}

}  // namespace
}  // namespace lacuna
