#include "scan/path_doubts.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "scan/recording_fixture.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::Contains;
using ::testing::HasSubstr;
using ::testing::Not;

// A jaw that moves along x by 1 mm a second and turns about z by `turn` rad, a row every 0.1 s.
RecordedGrip MovingJaw(int rows, double turn = 0) {
  RecordedGrip jaw;
  jaw.motion = GripMotion::kGiven;
  jaw.times = Eigen::VectorXd::LinSpaced(rows, 0, 0.1 * (rows - 1));
  jaw.displacements = Eigen::Matrix3Xd::Zero(3, rows);
  jaw.displacements.row(0) = 1e-3 * jaw.times.transpose();
  jaw.rotations = Eigen::Matrix3Xd::Zero(3, rows);
  jaw.turns_in_radians = true;
  jaw.rotations.row(2) = Eigen::RowVectorXd::LinSpaced(rows, 0, turn);
  return jaw;
}

// The times from `row` on are later by `pause`, s.
RecordedGrip WithPause(RecordedGrip jaw, Eigen::Index row, double pause) {
  jaw.times.tail(jaw.times.size() - row).array() += pause;
  return jaw;
}

TEST(PathDoubts, AreRaisedByAGapInWhichTheGripMoves) {
  RecordedGrip jaw = MovingJaw(21);
  EXPECT_EQ(DoubtOfGap(jaw, 0, 2), "");
  EXPECT_EQ(DoubtOfGap(WithPause(jaw, 10, 0.5), 0, 2), "") << "six intervals";
  jaw.displacements(0, 10) += 0.5e-3;
  const RecordedGrip gap = WithPause(jaw, 10, 1.5);
  EXPECT_THAT(DoubtOfGap(gap, 0, 3),
              AllOf(HasSubstr("no row between 0.9 s and 2.5 s, 16 times"), HasSubstr("moves")));
  EXPECT_EQ(DoubtOfGap(gap, 0, 0.8), "") << "after the last frame";
  RecordedGrip still = gap;
  still.displacements.col(10) = still.displacements.col(9);
  EXPECT_EQ(DoubtOfGap(still, 0, 3), "");
  // Rows where the velocity changes only.
  RecordedGrip corners = MovingJaw(12);
  for (const Eigen::Index row : {4, 8}) corners = WithPause(corners, row, 5);
  EXPECT_EQ(DoubtOfGap(corners, 0, 12), "");
}

TEST(PathDoubts, AreRaisedByAJumpBeyondTheObjectsSize) {
  RecordedGrip jaw = MovingJaw(21);
  EXPECT_EQ(DoubtOfJump(jaw, 0.07, 2), "");
  jaw.displacements.row(0).tail(20).array() += 0.1523;
  EXPECT_THAT(DoubtOfJump(jaw, 0.07, 2), HasSubstr("by 152 mm from 0 s to 0.1 s"));
  EXPECT_EQ(DoubtOfJump(jaw, 0.2, 2), "");
  EXPECT_EQ(DoubtOfJump(jaw, 0.07, 0), "") << "after the last frame";
}

TEST(PathDoubts, AreRaisedByATurnThatIsNoRotationVectorInRadians) {
  constexpr double kFull = 2 * std::numbers::pi;
  const auto doubt_of = [](RecordedGrip jaw, const std::vector<std::string>& columns) {
    jaw.turn_columns = columns;
    return DoubtOfTurn(jaw);
  };
  const std::vector<std::string> names{"rx", "ry", "rz"};
  EXPECT_NEAR(RangeOfPath(MovingJaw(21, 0.9 * kFull)).turn, 0.9 * kFull, 1e-9);
  EXPECT_NEAR(RangeOfPath(MovingJaw(21)).shift, 2e-3, 1e-12);
  EXPECT_EQ(doubt_of(MovingJaw(21, 0.9 * kFull), names), "");
  EXPECT_THAT(doubt_of(MovingJaw(21, 4.5 * kFull), names),
              AllOf(HasSubstr("by 4.5 full turns"), HasSubstr("unit: deg")));
  RecordedGrip jaw = MovingJaw(21, 0.5);
  EXPECT_THAT(doubt_of(jaw, {"q.x", "q.y", "q.z"}), HasSubstr("a quaternion"));
  EXPECT_EQ(doubt_of(jaw, {"roll", "pitch", "yaw"}), "") << "about one axis";
  jaw.rotations.row(0) = jaw.rotations.row(2);
  EXPECT_THAT(doubt_of(jaw, {"roll", "pitch", "yaw"}), HasSubstr("about several axes"));
  EXPECT_EQ(doubt_of(jaw, names), "");
  jaw = MovingJaw(21, 4.5 * kFull);
  jaw.turns_in_radians = false;
  EXPECT_EQ(doubt_of(jaw, names), "");
}

TEST_F(RecordingTest, WarnsOfADoubtfulPathAndTellsItsRange) {
  WriteClouds(2);
  const auto load = [&](double step, const std::string& unit) {
    folder_.Write("arm.csv",
                  fmt::format("t,x,y,z,qx,qy,qz\n0,0,0,0,0,0,0\n1,0,0,{},0,0,0.5\n", step));
    return Load(Yaml("  kind: points\n  files: f/*.csv\n  rate: 1 Hz\n",
                     "gripped: [{name: arm, sphere: {center: [0, 0, 0], radius: 5 mm}, path: "
                     "{file: arm.csv, time: t, x: x, y: y, z: z, turn: {x: qx, y: qy, z: qz, "
                     "unit: " +
                         unit + ", about: [0, 0, 0]}}}]\n"));
  };
  const Recording far = load(1e5, "rad");
  EXPECT_THAT(far.warnings, Contains(AllOf(HasSubstr("the path of arm"), HasSubstr("quaternion"))));
  EXPECT_THAT(far.warnings, Contains(HasSubstr("by 1e+05 mm from 0 s to 1 s")));
  const Recording near = load(2, "deg");
  EXPECT_THAT(near.warnings, Not(Contains(HasSubstr("the path of arm"))));
  EXPECT_THAT(DescribeRecording(near), HasSubstr("by up to 2 mm and 0.5° since its first row"));
}

}  // namespace
}  // namespace lacuna
