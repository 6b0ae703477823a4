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
  folder_.Write("load.csv", "# a remark\nt,x,y,z\n\n0,0,0,1\n1,0,inf,1\n");
  EXPECT_THAT(Error("file: load.csv" + columns), HasSubstr("load.csv:5: is not finite or does"));
  folder_.Write("load.csv", "# a remark\nt,x,y,z\n1,0,0,1\n1,0,0,1\n");
  EXPECT_THAT(Error("file: load.csv" + columns), HasSubstr("load.csv:4: is not finite or does"));
  folder_.Write("load.csv", "t,x,y,z\n,0,0,1\n");
  EXPECT_THAT(Error("file: load.csv" + columns), HasSubstr("load.csv:2: is not finite or does"));
  Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(2, 4);  // twice the time 0
  WriteNpy(folder_ / "load.npy", rows);
  EXPECT_THAT(Error("file: load.npy, time: \"1\", x: \"2\", y: \"3\", z: \"4\""),
              HasSubstr("load.npy: row 2: is not finite or does"));
}

}  // namespace
}  // namespace lacuna
