#include "scan/measured_reaction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/recording_fixture.h"

namespace lacuna {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const char* const kFrames = "  kind: points\n  files: f/*.csv\n  rate: 20 Hz\n";

class MeasuredReactionTest : public RecordingTest {
 protected:
  MeasuredReactionTest() {
    WriteClouds(3);
    folder_.Write("load.csv", "t,fx,fz\n0,1000,10\n100,3000,30\n");
    folder_.Write("jaw.csv", "t,x,y,z\n0,0,0,0\n1,0,0,1\n");
  }
  // A recording whose second held part has the reading `force`.
  static std::string WithForce(const std::string& force) {
    return Yaml(kFrames,
                "fixed: [{name: base, nodes: [1]}]\n"
                "gripped:\n"
                "  - {name: jaw, nodes: [2], path: {file: jaw.csv, time: t, x: x, y: y, z: z},\n"
                "     measured_force: " +
                    force + "}\n");
  }
};

TEST_F(MeasuredReactionTest, ComponentsAreReadInTheirUnitsAndInterpolated) {
  const Recording recording = Load(
      WithForce("{file: load.csv, time: t, time_unit: ms, x: fx, z: fz, unit: mN, deviation: 2 mN, "
                "tare_deviation: 0.1 N}"));
  ASSERT_EQ(recording.object.reactions.size(), 1u);
  const MeasuredReaction& reaction = recording.object.reactions[0];
  EXPECT_EQ(reaction.name, "jaw");
  EXPECT_EQ(reaction.held, 1u);  // after the fixed part
  EXPECT_THAT(reaction.labels, ElementsAre("x", "z"));
  EXPECT_NEAR(reaction.deviation, 0.002, 1e-15);
  EXPECT_EQ(reaction.tare_deviation, 0.1);
  EXPECT_TRUE(reaction.Covers(0.1));
  EXPECT_TRUE(reaction.Covers(0.10004)) << "within a thousandth of the interval between frames";
  EXPECT_FALSE(reaction.Covers(0.11));
  EXPECT_LT((ReadingAt(reaction, 0.05) - Eigen::Vector2d(2, 0.02)).norm(), 1e-12);
  EXPECT_THAT(DescribeRecording(recording), HasSubstr("jaw: 2 values of x, z, at most 3 N"));
  EXPECT_THAT(recording.files, testing::Contains(StateOf(folder_.Path() / "load.csv")));
}

TEST_F(MeasuredReactionTest, AnotherUnitInTheNameOfAColumnIsRefused) {
  folder_.Write("kn.csv", "t [s],Force [kN],Force (min)\n0,1,2\n1,2,3\n");
  const auto force = [&](const std::string& value, const std::string& more) {
    return LoadError(WithForce("{file: kn.csv, time: \"t [s]\", along: [0, 0, 1], value: \"" +
                               value + "\", deviation: 1 mN" + more + "}"));
  };
  EXPECT_THAT(force("Force [kN]", ""),
              HasSubstr("kn.csv: has a column \"Force [kN]\", but its values are read in another "
                        "unit; say `unit: kN`"));
  EXPECT_EQ(force("Force [kN]", ", unit: kN"), "no error");
  EXPECT_EQ(force("Force (min)", ""), "no error") << "a remark, not a unit of force";
  EXPECT_THAT(force("Force [kN]", ", unit: kN, time_unit: ms"), HasSubstr("say `time_unit: s`"));
}

TEST_F(MeasuredReactionTest, TheUnitOfAColumnMayStandInOtherPlaces) {
  const auto error = [&](const std::string& header, const std::string& more = "") {
    folder_.Write("u.csv", header + "0,1\n1,2\n");
    return LoadError(
        WithForce("{file: u.csv, time: \"1\", along: [0, 0, 1], value: \"2\", "
                  "deviation: 1 mN" +
                  more + "}"));
  };
  for (const char* name : {"F/kN", "F_kN", "F_KN", "F in kN", "F <kN>", "\"F, kN\"", "F (in kN)",
                           "F [KN]", "F [kn]"}) {
    EXPECT_THAT(error(std::string("t,") + name + "\n"), HasSubstr("say `unit: kN`")) << name;
    EXPECT_EQ(error(std::string("t,") + name + "\n", ", unit: kN"), "no error") << name;
  }
  EXPECT_THAT(error("t,F\ns,kN\n"), HasSubstr("say `unit: kN`")) << "a line of units";
  EXPECT_THAT(error("t,F\n(ms),(N)\n"), HasSubstr("say `time_unit: ms`"));
  EXPECT_THAT(error("t,F [lbf]\n"), HasSubstr("say `unit: lbf`"));
  for (const char* name : {"F [kg]", "F [g]", "F [V]", "F (mV)", "F [mm]", "F [%]"})
    EXPECT_THAT(error(std::string("t,") + name + "\n"), HasSubstr("not a unit of a force")) << name;
  for (const char* name : {"Load [cell 1]", "F [1]", "F (left)", "F [N]", "F/N", "F_h", "F [n]"})
    EXPECT_EQ(error(std::string("t,") + name + "\n"), "no error") << name;
}

TEST_F(MeasuredReactionTest, ADirectionIsNormalisedAndTheOppositeForceChangesItsSign) {
  const Recording recording = Load(
      WithForce("{file: load.csv, time: t, time_unit: ms, along: [0, 0, 2], value: fz, unit: N, "
                "exerted_by: object}"));
  const MeasuredReaction& reaction = recording.object.reactions.at(0);
  EXPECT_EQ(reaction.directions, Eigen::Vector3d::UnitZ());
  EXPECT_EQ(reaction.values(0, 1), -30);
}

TEST_F(MeasuredReactionTest, AFixedPartMayHaveALoadCellToo) {
  const Recording recording =
      Load(Yaml(kFrames,
                "fixed: [{nodes: [1]}, {name: base, nodes: [2], measured_force: {file: load.csv, "
                "time: t, time_unit: ms, z: fz}}]\n"));
  EXPECT_EQ(recording.object.reactions.at(0).held, 1u);
  EXPECT_EQ(recording.object.reactions.at(0).name, "base");
}

// Each message names the file, the line and the field.
TEST_F(MeasuredReactionTest, MistakesAreNamedWithTheirPlace) {
  const auto error = [&](const std::string& force) { return LoadError(WithForce(force)); };
  EXPECT_THAT(error("{file: load.csv, time: t, z: fz, unit: mm}"),
              AllOf(HasSubstr("recording.yaml:7"), HasSubstr("gripped[0].measured_force.unit"),
                    HasSubstr("a force")));
  EXPECT_THAT(error("{file: lost.csv, time: t, z: fz}"),
              AllOf(HasSubstr("recording.yaml:7"), HasSubstr("gripped[0].measured_force.file"),
                    HasSubstr("there is no file")));
  EXPECT_THAT(error("{file: load.csv, time: t, z: fz, along: [0, 0, 1], value: fz}"),
              AllOf(HasSubstr("recording.yaml:7"), HasSubstr("measured_force.along"),
                    HasSubstr("already have columns")));
  EXPECT_THAT(error("{file: load.csv, time: t}"),
              AllOf(HasSubstr("recording.yaml:7"), HasSubstr("direction")));
  EXPECT_THAT(error("{file: load.csv, time: t, along: [0, 0, 0], value: fz}"),
              AllOf(HasSubstr("measured_force.along"), HasSubstr("other than 0")));
  EXPECT_THAT(error("{file: load.csv, time: t, along: [0, 0, 1]}"), HasSubstr("value"));
  EXPECT_THAT(error("{file: load.csv, time: t, z: force}"),
              AllOf(HasSubstr("load.csv"), HasSubstr("force")));
  EXPECT_THAT(error("{file: load.csv, time: t, z: fz, deviation: -1 N}"),
              HasSubstr("measured_force.deviation"));
  EXPECT_THAT(error("{file: load.csv, time: t, z: fz, tare_deviaton: 1 N}"),
              HasSubstr("tare_deviation"));
}

TEST_F(MeasuredReactionTest, WhatIsWrittenIsReadAgain) {
  const Recording recording = Load(WithForce(
      "{file: load.csv, time: t, time_unit: ms, x: fx, z: fz, unit: N, deviation: 0.5 N}"));
  const MeasuredReaction& reaction = recording.object.reactions.at(0);
  std::string entry = WriteReaction(folder_.Path(), reaction, 1);
  entry.erase(0, std::string("measured_force: ").size());
  const Recording again = Load(WithForce(entry));
  const MeasuredReaction& read = again.object.reactions.at(0);
  EXPECT_EQ(read.labels, reaction.labels);
  EXPECT_EQ(read.values, reaction.values);
  EXPECT_EQ(read.times, reaction.times);
  EXPECT_EQ(read.deviation, reaction.deviation);
}

}  // namespace
}  // namespace lacuna
