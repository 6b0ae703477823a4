// Times and forces in tables of image correlation: in their headers, or in columns of one table
// that holds all steps.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "scan/displacement_table_fixture.h"
#include "scan/recording.h"
#include "scan/table_header.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// A nodemap with what ARAMIS writes above the rows.
std::string Nodemap(double time, double force, double w) {
  return "# Process data:\n# project_creation_time         : 09.06.2021 13:10\n"
         "# calibration_object            : CP 20 / 175x140mm (ID: D10601)\n"
         "####################\n# SIGNALS:\n"
         "# force                         : value_element       : " +
         std::to_string(force) +
         "\n# time                          : value_element       : " + std::to_string(time) +
         "\n# Kraft: 1.5 kN\n#\n#" + Rows(0, 8, w);
}

TEST_F(DisplacementTable, HasTheTimesAndForcesOfItsHeaders) {
  folder_.Write("f/s_9.txt", Nodemap(100, 0, 0));
  folder_.Write("f/s_10.txt", Nodemap(102.5, -14985.5, 1));
  folder_.Write("f/s_11.txt", Nodemap(104, 20, 2));
  const auto yaml = [](const std::string& frames, const std::string& force) {
    return Yaml(
        "  kind: points\n  files: f/*.txt\n" + frames,
        force.empty() ? "" : "fixed: [{name: base, nodes: [1], measured_force: " + force + "}]\n");
  };
  const Recording recording =
      Load(yaml("", "{from: headers, along: [0, 1, 0], value: force, unit: kN, deviation: 1 N}"));
  EXPECT_THAT(recording.times, ElementsAre(100, 102.5, 104));
  const MeasuredReaction& force = recording.object.reactions.at(0);
  EXPECT_EQ(force.times, Eigen::Vector3d(100, 102.5, 104));
  EXPECT_NEAR(force.values(0, 1), -14985500, 1e-6);
  EXPECT_TRUE(force.Covers(103));
  // A part of the frames has the values of its own headers.
  const Recording later = Load(yaml("  from: 101 s\n", ""));
  EXPECT_THAT(later.times, ElementsAre(102.5, 104));
  EXPECT_THAT(Load(yaml("  rate: 2 Hz\n", "")).times, ElementsAre(0, 0.5, 1));
  EXPECT_THAT(LoadError(yaml("  header: {time: force}\n", "")), HasSubstr("is not later than"));
  EXPECT_THAT(LoadError(yaml("  header: {time: time}\n  rate: 2 Hz\n", "")),
              HasSubstr("the times are given more than once"));
}

TEST_F(DisplacementTable, NamesAHeaderThatLacksAValue) {
  folder_.Write("f/s_1.txt", Nodemap(100, 0, 0));
  folder_.Write("f/s_2.txt", Nodemap(102, 1, 1));
  const auto error = [&](const std::string& force) {
    return LoadError(Yaml("  {kind: points, files: f/*.txt}\n",
                          "fixed: [{name: base, nodes: [1], measured_force: " + force + "}]\n"));
  };
  EXPECT_THAT(error("{from: headers, along: [0, 1, 0], value: load}"),
              HasSubstr("s_1.txt: has no value \"load\" in its header, which has Kraft, force, "
                        "time"));
  EXPECT_THAT(error("{from: headers, along: [0, 1, 0], value: Kraft}"),
              HasSubstr("gives \"Kraft\" in kN; recording.yaml says N"));
  EXPECT_THAT(error("{from: headers, file: a.csv, along: [0, 1, 0], value: force}"),
              HasSubstr("from: headers` already"));
}

TEST_F(DisplacementTable, GivesAPathInItsUnit) {
  folder_.Write("f/s_1.txt", "# X: 0 mm\n" + Nodemap(100, 0, 0));
  folder_.Write("f/s_2.txt", "# X: 3 mm\n" + Nodemap(102, 1, 1));
  const auto yaml = [](const std::string& unit) {
    return Yaml("  {kind: points, files: f/*.txt}\n",
                "gripped: [{nodes: [1], path: {from: headers, x: X, y: X, z: X, length_unit: " +
                    unit + "}}]\n");
  };
  EXPECT_NEAR(Load(yaml("mm")).object.grips.at(0).displacements(0, 1), 3e-3, 1e-15);
  EXPECT_THAT(LoadError(yaml("m")), HasSubstr("gives \"X\" in mm; recording.yaml says m"));
}

TEST_F(DisplacementTable, HasHeadersWithDecimalCommas) {
  const auto write = [&](const std::string& name, const std::string& time,
                         const std::string& force) {
    std::string text = "# time : " + time + "\n# force : " + force + "\nx;y;z\n";
    for (int i = 0; i < 8; ++i)
      text +=
          std::to_string(i) + ",5;" + std::to_string(i * i) + ";" + std::to_string(i % 3) + "\n";
    folder_.Write(name, text);
  };
  write("f/a.csv", "0,00", "1,005");
  write("f/b.csv", "0,50", "2,5");
  const Recording recording = Load(
      Yaml("  {kind: points, files: f/*.csv}\n",
           "fixed: [{name: base, nodes: [1], measured_force: {from: headers, along: [0, 1, 0], "
           "value: force, deviation: 1 N}}]\n"));
  EXPECT_THAT(recording.times, ElementsAre(0, 0.5));
  EXPECT_EQ(recording.object.reactions.at(0).values, Eigen::RowVector2d(1.005, 2.5));
  EXPECT_EQ(HeaderValuesIn("# force : 1,005\nx,y\n1.5,2\n").count("force"), 0u)
      << "the comma may separate thousands";
  EXPECT_EQ(HeaderValuesIn("# force : 1,5\nx,y\n1.5,2\n").at("force").value, 1.5);
}

// Three steps of eight points, in any order, as one file.
std::string AllSteps() {
  std::string text = "step,t_ms,point,X0,Y0,Z0,dX,dY,dZ,s\n";
  for (const int step : {2, 0, 1})
    for (int k = 0; k < 8; ++k) {
      const int i = step == 1 ? 7 - k : k;
      if (step == 2 && i == 5) continue;
      text += std::to_string(step) + "," + std::to_string(500 * step) + "," + std::to_string(i) +
              "," + std::to_string(10 * i) + "," + std::to_string(i * 7 % 11) + "," +
              std::to_string(i * 5 % 3) + "," + std::to_string(step) + ",0,0,0.5\n";
    }
  return text;
}

TEST_F(DisplacementTable, MayHoldAllSteps) {
  folder_.Write("all.csv", AllSteps());
  const std::string columns =
      "x: X0, y: Y0, z: Z0, u: dX, v: dY, w: dZ, sigma: s, id: point, step: step";
  const Recording recording =
      Load(Yaml("  kind: points\n  file: all.csv\n  time_unit: ms\n  columns: {" + columns +
                ", time: t_ms}\n"));
  EXPECT_THAT(recording.times, ElementsAre(0, 0.5, 1));
  EXPECT_TRUE(HasTrackedPoints(recording));
  for (int i = 0; i < 3; ++i) {
    const Frame frame = LoadFrame(recording, i);
    ASSERT_EQ(frame.cloud.Size(), i == 2 ? 7 : 8);
    EXPECT_EQ(frame.source_row[6], i == 2 ? 7 : 6);
    EXPECT_LT((frame.cloud.points.col(2) - 1e-3 * Eigen::Vector3d(20 + i, 3, 1)).norm(), 1e-12);
  }
  // The steps that are chosen, with times from elsewhere.
  const Recording last =
      Load(Yaml("  kind: points\n  file: all.csv\n  rate: 2 Hz\n  from: 1 s\n  "
                "columns: {" +
                columns + "}\n"));
  ASSERT_EQ(last.FrameCount(), 1);
  EXPECT_EQ(LoadFrame(last, 0).cloud.Size(), 7);
}

TEST_F(DisplacementTable, OfAllStepsNeedsAColumnThatTellsThemApart) {
  folder_.Write("all.csv", AllSteps());
  EXPECT_THAT(LoadError(Yaml("  {kind: points, file: all.csv, rate: 1 Hz}\n")),
              HasSubstr("names the column that tells them apart"));
  EXPECT_THAT(LoadError(Yaml("  {kind: points, file: all.csv, columns: {step: frame}}\n")),
              HasSubstr("has no column \"frame\""));
  EXPECT_THAT(LoadError(Yaml("  {kind: points, file: none.csv, columns: {step: frame}}\n")),
              HasSubstr("there is no file"));
  folder_.Write("all.csv", "step,t,x,y,z,u,v,w\n0,0,1,2,3,0,0,0\n0,1,1,2,3,0,0,0\n");
  EXPECT_THAT(LoadError(Yaml("  {kind: points, file: all.csv, columns: {step: step, time: t}}\n")),
              HasSubstr("all.csv:3:1: \"t\" is 1 where line 2, of the same step, has 0"));
  folder_.Write("all.csv", "step,t,x,y,z,u,v,w\n0,0,1,2,3,0,0,0\n,1,1,2,3,0,0,0\n");
  EXPECT_THAT(LoadError(Yaml("  {kind: points, file: all.csv, columns: {step: step}}\n")),
              HasSubstr("all.csv:3:1: \"step\" is not finite"));
}

// What GOM Correlate and ARAMIS Professional write, with places in the deformed state.
std::string Gom(int stage, double time, double u) {
  std::string text = "# Units: length:mm angle:deg time:s \n# Stage: Stufe " +
                     std::to_string(stage) + "\nstage;index;relative_time;date\n\"Stufe " +
                     std::to_string(stage) + "\";" + std::to_string(stage) + ";" +
                     std::to_string(time) +
                     ";\"2023-02-10T13:54:18.404\"\n# Name : Fl\xC3\xA4"
                     "che 1\n"
                     "id;x;y;z;displacement_x;displacement_y;displacement_z;epsilon_x\n";
  for (int i = 0; i < 8; ++i)
    text += std::to_string(i) + ";" + std::to_string(10 * i + u) + ";" +
            std::to_string(i * 7 % 11) + ";" + std::to_string(i * 5 % 3) + ";" + std::to_string(u) +
            ";0;0;0.001\n";
  return text;
}

TEST_F(DisplacementTable, OfGomHasPlacesInTheDeformedStateAndTimes) {
  folder_.Write("f/a_1.csv", Gom(1, 0, 0));
  folder_.Write("f/a_2.csv", Gom(2, 21.5551, 0.5));
  const Recording recording = Load(Yaml("  {kind: points, files: f/*.csv}\n"));
  EXPECT_THAT(recording.warnings, IsEmpty());
  EXPECT_THAT(recording.times, ElementsAre(0, 21.5551));
  const Frame frame = LoadFrame(recording, 1);
  ASSERT_EQ(frame.cloud.Size(), 8);
  EXPECT_LT((frame.cloud.points.col(1) - 1e-3 * Eigen::Vector3d(10.5, 7, 2)).norm(), 1e-12)
      << "the displacement is not added again";
  EXPECT_THAT(Load(Yaml("  {kind: points, files: f/*.csv}\n", "", "cm")).warnings,
              ElementsAre(HasSubstr("lengths are in mm")));
}

}  // namespace
}  // namespace lacuna
