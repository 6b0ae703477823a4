#include "scan/recorded_grip.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "scan/recording_fixture.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;

TEST_F(RecordingTest, AGripRotatesAndShiftsSmoothlyAlongItsPath) {
  WriteClouds(3);
  std::string path = "t,x,y,z,rx,ry,rz\n";
  const auto shift = [](double t) { return 3 * std::sin(20 * t); };  // mm
  for (int k = 0; k <= 10; ++k)
    path += fmt::format("{0},1,{1},0,10,0,{2}\n", 0.01 * k, shift(0.01 * k), 300 * 0.01 * k);
  folder_.Write("arm.csv", path);
  const std::string yaml = "  kind: points\n  files: f/*.csv\n  rate: 20 Hz\n";
  const std::string grip =
      "gripped: [{name: arm, sphere: {center: [100 mm, 0, 0], radius: 5 mm}, path: {file: arm.csv, "
      "time: t, x: x, y: y, z: z, turn: {x: rx, y: ry, z: rz, unit: deg, about: [100 mm, 0, "
      "0]}}}]\n";
  const Recording recording = Load(Yaml(yaml, grip));
  const RecordedGrip& arm = recording.object.grips.at(0);
  const Eigen::Vector3d pivot(0.1, 0, 0);
  // The first row belongs to the undeformed place, whatever its numbers are.
  EXPECT_LT((MotionAt(arm, 0).matrix() - Eigen::Matrix4d::Identity()).norm(), 1e-15);
  // Half way between two rows, with ω h = 0.2, the cubic is off by (ω h)⁴ (1/48 + 1/384) of 3 mm.
  // Linear interpolation would be off by (ω h)²/8 of it, which is 15 µm.
  const Eigen::Isometry3d there = MotionAt(arm, 0.045);
  EXPECT_NEAR((there * pivot - pivot).y(), 1e-3 * shift(0.045), 1.2e-7);
  const double degree = std::numbers::pi / 180;
  const Eigen::Vector3d turned(10 * degree, 0, 13.5 * degree);
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(turned.norm(), turned.normalized()).toRotationMatrix() *
      Eigen::AngleAxisd(-10 * degree, Eigen::Vector3d::UnitX());
  EXPECT_LT((there.linear() - rotation).norm(), 1e-12);
  // The velocity is continuous at a row.
  const auto at = [&](double t) { return MotionAt(arm, t).translation().eval(); };
  const double h = 1e-6;
  EXPECT_LT((at(0.05 + h) - 2 * at(0.05) + at(0.05 - h)).norm() / h, 1e-5);
  EXPECT_THAT(LoadError(Yaml(yaml,
                             "gripped: [{nodes: [1], path: {file: arm.csv, time: t, turn: {x: "
                             "rx, y: rz, z: r}}}]\n")),
              HasSubstr("r"));
}

// The last time step of a prediction ends after the last row of a path that ends with the frames.
TEST(MotionAfterTheLastRow, GoesOnAsItWasBefore) {
  RecordedGrip grip;
  grip.motion = GripMotion::kGiven;
  grip.times = Eigen::Vector3d(0, 1, 1.5);
  grip.displacements.resize(3, 3);
  grip.displacements << 0, 0, 0, 0, 0.01, 0.03, 0, 0, 0;
  grip.rotations = Eigen::Matrix3Xd::Zero(3, 3);
  grip.rotations.row(2) << 0.3, 0.5, 0.6;
  grip.pivot = {0, 0.01, 0};
  // The velocities are 0.03 m/s and 0.04 m/s at the last two rows: between them, at 1.25 s, the
  // grip is at 0.02 m + 0.5 s / 8 · (0.03 − 0.04) m/s = 0.019375 m. It turns by 0.2 rad/s there.
  const auto moved = [&](double time) -> Eigen::Vector3d {
    return MotionAt(grip, time) * grip.pivot - grip.pivot;
  };
  const auto turned = [&](double time) -> Eigen::Vector3d {
    const Eigen::AngleAxisd turn(MotionAt(grip, time).linear());
    return turn.angle() * turn.axis();
  };
  EXPECT_LT((moved(1.25) - Eigen::Vector3d(0, 0.019375, 0)).norm(), 1e-15);
  EXPECT_LT((turned(1.25) - Eigen::Vector3d(0, 0, 0.25)).norm(), 1e-12);
  EXPECT_LT((moved(1.75) - Eigen::Vector3d(0, 0.060 - 0.019375, 0)).norm(), 1e-15);
  EXPECT_LT((turned(1.75) - Eigen::Vector3d(0, 0, 0.35)).norm(), 1e-12);
  // No farther than it came, however late.
  for (const double time : {3.0, 4.0, 100.0}) {
    EXPECT_LT((moved(time) - Eigen::Vector3d(0, 0.060, 0)).norm(), 1e-15) << time;
    EXPECT_LT((turned(time) - Eigen::Vector3d(0, 0, 0.6)).norm(), 1e-12) << time;
  }
}

TEST(MotionAfterTheLastRow, OfASingleRowIsRest) {
  RecordedGrip grip;
  grip.motion = GripMotion::kGiven;
  grip.times = Eigen::VectorXd::Constant(1, 0.5);
  grip.displacements = Eigen::Matrix3Xd::Zero(3, 1);
  EXPECT_EQ(MotionAt(grip, 2).matrix(), Eigen::Matrix4d::Identity());
}

TEST_F(RecordingTest, ATurnIsMadeContinuous) {
  WriteClouds(2);
  const auto load = [&](const std::string& last) {
    folder_.Write("arm.csv", "t,x,y,z,rx,ry,rz\n0,0,0,0,0,0,170\n1,0,0,0," + last + "\n");
    return Load(
        Yaml("  kind: points\n  files: f/*.csv\n  rate: 1 Hz\n",
             "gripped: [{name: arm, sphere: {center: [0, 0, 0], radius: 5 mm}, path: {file: "
             "arm.csv, time: t, x: x, y: y, z: z, turn: {x: rx, y: ry, z: rz, unit: deg, about: "
             "[0, 0, 0]}}}]\n"));
  };
  EXPECT_THAT(ErrorOf([&] { load("170,0,0"); }),
              AllOf(HasSubstr("arm.csv:3"), HasSubstr("more than 180°")));
  // Robots give −170° where the angle passes 180°.
  const double degree = std::numbers::pi / 180;
  for (const char* last : {"0,0,190", "0,0,-170"})
    EXPECT_NEAR(load(last).object.grips.at(0).rotations(2, 1), 190 * degree, 1e-12) << last;
}

TEST_F(RecordingTest, APathHasItsOwnColumns) {
  WriteClouds(2);
  folder_.Write("arm.csv", "t,x,y,z\n0,0,0,0\n1,7,8,9\n");
  const Recording recording =
      Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n",
                "gripped: [{nodes: [1], path: {file: arm.csv, time: t, length_unit: m}}]\n"));
  EXPECT_EQ(recording.object.grips.at(0).displacements.col(1), Eigen::Vector3d(7, 8, 9));
}

// A testing machine measures one displacement.
TEST_F(RecordingTest, APathMayHaveOneComponent) {
  WriteClouds(2);
  folder_.Write("machine.csv", "t,F,crosshead\n0,5,1\n1,6,3\n");
  const auto yaml = [](const std::string& component) {
    return Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n",
                "gripped: [{nodes: [1], path: {file: machine.csv, time: t, length_unit: mm, " +
                    component + "}}]\n");
  };
  const auto moved = [&](const std::string& component) {
    return Eigen::Vector3d(Load(yaml(component)).object.grips.at(0).displacements.col(1));
  };
  EXPECT_LT((moved("z: crosshead") - Eigen::Vector3d(0, 0, 2e-3)).norm(), 1e-15);
  EXPECT_LT(
      (moved("along: [0, 3, 4], value: crosshead") - Eigen::Vector3d(0, 1.2e-3, 1.6e-3)).norm(),
      1e-15);
  folder_.Write("machine.csv", "t,x,crosshead\n0,5,1\n1,6,3\n");
  EXPECT_THAT(LoadError(yaml("z: crosshead")),
              HasSubstr("has a column \"x\", but `x` is not given"));
}

TEST_F(RecordingTest, PartsMayBeHeldAlongSomeAxesOnly) {
  WriteClouds(2);
  folder_.Write("plate.csv", "t,x,y,z,rx,ry,rz\n0,0,0,0,0,0,0\n1,0,0,-2,0,0,1\n");
  const std::string frames = "  kind: points\n  files: f/*.csv\n  rate: 1 Hz\n";
  const std::string path = "path: {file: plate.csv, time: t, x: x, y: y, z: z";
  const auto parts = [&](const std::string& fixed, const std::string& gripped) {
    return Yaml(frames, "fixed: [{name: plane, half_space: {point: [0, 0, 0], normal: [-1, 0, 0]}" +
                            fixed + "}]\ngripped: [{name: plate, nodes: [3], " + gripped + "}]\n");
  };
  const Recording recording = Load(parts(", directions: [x, z]", path + "}, directions: [z]"));
  const RecordedSupport& plane = recording.object.fixed.at(0);
  EXPECT_EQ(plane.axes, AxisSet::Of(0) | AxisSet::Of(2));
  EXPECT_EQ(recording.object.grips.at(0).axes, AxisSet::Of(2));
  EXPECT_THAT(DescribeSupport(plane), HasSubstr("along x, z only"));
  EXPECT_THAT(WriteSupport(plane), HasSubstr(", directions: [x, z]}"));
  EXPECT_THAT(DescribeGrip(recording.object.grips.at(0)), HasSubstr("held along z only"));
  EXPECT_TRUE(Load(parts("", path + "}")).object.fixed.at(0).axes.IsAll());

  const auto error = [&](const std::string& fixed, const std::string& gripped) {
    return LoadError(parts(fixed, gripped));
  };
  EXPECT_THAT(error(", directions: [x, north]", path + "}"),
              AllOf(HasSubstr("fixed[0].directions[1]"), HasSubstr("expected x, y or z")));
  EXPECT_THAT(error(", directions: [x, x]", path + "}"), HasSubstr("x appears twice"));
  EXPECT_THAT(error(", directions: []", path + "}"), HasSubstr("is empty"));
  EXPECT_THAT(error("", "follows: scan, directions: [z]"),
              AllOf(HasSubstr("gripped[0].directions"), HasSubstr("needs a `path`")));
  EXPECT_THAT(error("", path + ", turn: {x: rx, y: ry, z: rz, about: [0, 0, 0]}}, directions: [z]"),
              HasSubstr("cannot be combined with a `turn`"));
  EXPECT_THAT(
      error(", directions: [x], measured_force: {file: plate.csv, time: t, y: y}", path + "}"),
      AllOf(HasSubstr("measured_force"), HasSubstr("along y, along which plane is not held")));
}

}  // namespace
}  // namespace lacuna
