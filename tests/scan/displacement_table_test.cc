#include "scan/displacement_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scan/recording_fixture.h"
#include "scan/table_header.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

Eigen::Matrix3Xd Moved(DelimitedTable table) {
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  EXPECT_TRUE(columns.has_value());
  return columns ? MovedPoints(table, *columns) : Eigen::Matrix3Xd(3, 0);
}

class DisplacementTable : public RecordingTest {
 protected:
  DelimitedTable Table(const std::string& content) const {
    return ReadDelimitedTable(folder_.Write("table.txt", content));
  }
};

const std::string kVic =
    "\"X\",\"Y\",\"Z\",\"U\",\"V\",\"W\",\"sigma\",\"x\",\"y\"\n"
    "0,0,0,0,0,0,0.01,310,20\n"
    "10,0,0,0.5,0,-0.25,0.01,340,20\n"
    "0,10,0,0,1,0,0.01,310,50\n"
    "0,0,10,0,0,2,0.02,310,20\n"
    "10,10,0,9,9,9,-1,340,50\n";

TEST_F(DisplacementTable, OfVic3dHasMetricPlacesBesidePixels) {
  const Eigen::Matrix3Xd points = Moved(Table(kVic));
  ASSERT_EQ(points.cols(), 5);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(0, 0, 0)) << "one point may be at the origin";
  EXPECT_EQ(points.col(1), Eigen::Vector3d(10.5, 0, -0.25));
  EXPECT_TRUE(points.col(4).array().isNaN().all()) << "sigma is −1";
}

TEST_F(DisplacementTable, OfDiceFollowsItsBlockOfStars) {
  const Eigen::Matrix3Xd points = Moved(
      Table("***\n*** Digital Image Correlation Engine, a block of remarks, with commas\n***\n"
            "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,"
            "MODEL_COORDINATES_X,MODEL_COORDINATES_Y,MODEL_COORDINATES_Z,MODEL_DISPLACEMENT_X,"
            "MODEL_DISPLACEMENT_Y,MODEL_DISPLACEMENT_Z,SIGMA,STATUS_FLAG\n"
            "0,100,200,1,1,1.5,2,3,0.25,0.5,1,0.01,4\n"
            "1,120,200,1,1,2.5,2,3,0.25,0.5,1,-1,9\n"
            "2,140,200,1,1,3.5,2,3,0.25,0.5,1,0.01,8\n"
            "3,160,200,1,1,4.5,2,3,0.25,nan,1,0.01,0\n"));
  ASSERT_EQ(points.cols(), 4);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(1.75, 2.5, 4));
  for (int failed = 1; failed < 4; ++failed) EXPECT_FALSE(points.col(failed).allFinite()) << failed;
}

TEST_F(DisplacementTable, OfDiceWithoutAStatusHasFailed) {
  const Eigen::Matrix3Xd points =
      Moved(Table("MODEL_COORDINATES_X,MODEL_COORDINATES_Y,MODEL_COORDINATES_Z,"
                  "MODEL_DISPLACEMENT_X,MODEL_DISPLACEMENT_Y,MODEL_DISPLACEMENT_Z,STATUS_FLAG\n"
                  "1,2,3,1,1,1,4\n1,2,3,1,1,1,\n1,2,3,1,1,1,nan\n"));
  ASSERT_EQ(points.cols(), 3);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(2, 3, 4));
  for (const int unknown : {1, 2}) EXPECT_TRUE(points.col(unknown).array().isNaN().all());
}

TEST_F(DisplacementTable, OfAramisHasItsNamesInTheLastComment) {
  DelimitedTable table = Table(
      "####\n# Facet size: 19.0\n# Force; with a semicolon: 12 N\n####\n#\n"
      "#ID,ID; x_undef [mm]; y_undef [mm]; z_undef [mm]; u [mm]; v [mm]; w [mm]; epsx [%]\n"
      "7; 1.0; 2.0; 3.0; 0.5; -0.5; 0.25; 1\n"
      "9; 2.0; 2.0; 3.0; 0.5; -0.5; 0.25; 1\n");
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  ASSERT_TRUE(columns.has_value());
  EXPECT_EQ(columns->length_unit, "mm");
  EXPECT_EQ(columns->id, 0);
  EXPECT_FALSE(columns->has_common_names);
  EXPECT_EQ(MovedPoints(table, *columns).col(0), Eigen::Vector3d(1.5, 1.5, 3.25));
}

TEST_F(DisplacementTable, MayHaveUnitsWithoutABlank) {
  DelimitedTable table = Table("x[m],y[m],z[m],u[m],v[m],w[m]\n1,2,3,1,1,1\n");
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  ASSERT_TRUE(columns.has_value());
  EXPECT_EQ(columns->length_unit, "m");
  EXPECT_TRUE(columns->has_common_names);
}

TEST_F(DisplacementTable, ForgetsPointsThatAreZeroInSeveralRows) {
  const Eigen::Matrix3Xd points =
      Moved(Table("X,Y,Z,U,V,W,sigma\n0,0,0,0,0,0,0\n1,2,3,0,0,0,0.1\n0,0,0,0,0,0,0\n"));
  EXPECT_FALSE(points.col(0).allFinite());
  EXPECT_TRUE(points.col(1).allFinite());
  EXPECT_FALSE(points.col(2).allFinite());
}

TEST_F(DisplacementTable, IsNotSeenInOtherTables) {
  for (const char* content :
       {"x,y,z\n1,2,3\n", "x,y,z,u,v\n1,2,3,4,5\n", "1,2,3,4,5,6\n", "# x; y; z: remarks\n1;2;3\n",
        "# x y z u v w\n1 2 3 4 5\n", "# u; v; w; a; b; c\n1;2;3;4;5;6\n"}) {
    DelimitedTable table = Table(content);
    const std::vector<std::string> header = table.header;
    EXPECT_FALSE(FindDisplacementColumns(&table).has_value()) << content;
    EXPECT_EQ(table.header, header) << content;
  }
}

TEST_F(DisplacementTable, ThatCannotBeUsedIsExplained) {
  DelimitedTable plane = Table(
      "SUBSET_ID,COORDINATE_X,COORDINATE_Y,DISPLACEMENT_X,DISPLACEMENT_Y,SIGMA\n0,1,2,3,4,0.1\n");
  EXPECT_THAT(ErrorOf([&] { FindDisplacementColumns(&plane); }),
              HasSubstr("displacements in the image plane only (\"DISPLACEMENT_X\""));
  DelimitedTable units = Table("x [mm],y [mm],z [mm],u [um],v [um],w [um]\n1,2,3,4,5,6\n");
  EXPECT_THAT(ErrorOf([&] { FindDisplacementColumns(&units); }),
              HasSubstr("gives \"u [um]\" beside columns in mm"));
  EXPECT_THAT(ErrorOf([&] { Table("X,Y,Z,U,V,W\n1,2,3,4,5,6\n*** end\n"); }),
              HasSubstr("table.txt:3:1"))
      << "stars may stand above the table only";
}

// Rows of points of a body of 100 × 50 × 20, displaced along z.
std::string Rows(int first, int last, double w) {
  std::string text = "ID;x_undef [mm];y_undef [mm];z_undef [mm];u [mm];v [mm];w [mm]\n";
  for (int i = first; i < last; ++i)
    text += std::to_string(i) + ";" + std::to_string(i * 10) + ";" + std::to_string(i * 7 % 11) +
            ";" + std::to_string(i * 5 % 3) + ";0;0;" + std::to_string(w) + "\n";
  return text;
}

TEST_F(DisplacementTable, GivesTrackedPointsThatAreIdentifiedByNumber) {
  folder_.Write("f/a.txt", Rows(0, 8, 0));
  folder_.Write("f/b.txt", Rows(2, 9, 1.5));
  const Recording recording = Load(Yaml("  {kind: points, files: f/*.txt, rate: 1 Hz}\n"));
  EXPECT_TRUE(HasTrackedPoints(recording));
  EXPECT_THAT(recording.warnings, IsEmpty());
  const Frame frame = LoadFrame(recording, 1);
  EXPECT_EQ(frame.row_count, 8);
  ASSERT_EQ(frame.cloud.Size(), 6) << "two are not in the second file";
  EXPECT_EQ(frame.source_row[0], 2);
  EXPECT_LT((frame.cloud.points.col(0) - 1e-3 * Eigen::Vector3d(20, 3, 2.5)).norm(), 1e-12);
}

TEST_F(DisplacementTable, WarnsOfAnotherUnitAndOfCommonNames) {
  folder_.Write("a.txt", Rows(0, 8, 0));
  EXPECT_THAT(Load(Yaml("  {kind: points, files: [a.txt]}\n", "", "cm")).warnings,
              ElementsAre(HasSubstr("a.txt says that its lengths are in mm; recording.yaml says "
                                    "cm")));
  std::string common = "x,y,z,u,v,w\n";
  for (int i = 0; i < 8; ++i)
    common +=
        std::to_string(i) + "," + std::to_string(i * i) + "," + std::to_string(i % 3) + ",1,1,1\n";
  folder_.Write("b.csv", common);
  EXPECT_THAT(Load(Yaml("  {kind: points, files: [b.csv]}\n")).warnings,
              ElementsAre(HasSubstr("plus the displacements u, v, w")));
  const Recording named =
      Load(Yaml("  {kind: points, files: [b.csv], columns: {x: x, y: y, z: z}}\n"));
  EXPECT_THAT(named.warnings, IsEmpty());
  EXPECT_FALSE(HasTrackedPoints(named));
}

TEST_F(DisplacementTable, TakesColumnsThatAreNamed) {
  std::string rows = "a,b,c,da,db,dc,quality\n";
  for (int i = 0; i < 8; ++i)
    rows += std::to_string(i) + "," + std::to_string(i * i) + "," + std::to_string(i % 3) +
            ",1,2,3," + (i == 4 ? "-1" : "0") + "\n";
  folder_.Write("a.csv", rows);
  const Recording recording =
      Load(Yaml("  kind: points\n  files: [a.csv]\n"
                "  columns: {x: a, y: b, z: c, u: da, v: db, w: dc, sigma: quality}\n"));
  EXPECT_TRUE(HasTrackedPoints(recording));
  const Frame frame = LoadFrame(recording, 0);
  EXPECT_EQ(frame.cloud.Size(), 7);
  EXPECT_LT((frame.cloud.points.col(1) - 1e-3 * Eigen::Vector3d(2, 3, 4)).norm(), 1e-12);
  EXPECT_THAT(LoadError(Yaml("  kind: points\n  files: [a.csv]\n"
                             "  columns: {x: a, y: b, z: c, u: da, v: db}\n")),
              HasSubstr("w"));
}

// The quality of the points counts also where only places and displacements are named.
TEST_F(DisplacementTable, LeavesOutFailedPointsWhereColumnsAreNamed) {
  const auto points_with = [&](const std::string& column, const std::string& failed,
                               const std::string& fine, const std::string& more = "") {
    std::string rows = "a,b,c,da,db,dc," + column + "\n";
    for (int i = 0; i < 8; ++i)
      rows += std::to_string(i) + "," + std::to_string(i * i) + "," + std::to_string(i % 3) +
              ",1,2,3," + (i == 4 ? failed : fine) + "\n";
    folder_.Write("a.csv", rows);
    const Recording recording =
        Load(Yaml("  kind: points\n  files: [a.csv]\n"
                  "  columns: {x: a, y: b, z: c, u: da, v: db, w: dc" +
                  more + "}\n"));
    return LoadFrame(recording, 0).cloud.Size();
  };
  EXPECT_EQ(points_with("SIGMA", "-1", "0.1"), 7);
  EXPECT_EQ(points_with("STATUS_FLAG", "5", "4"), 7);
  EXPECT_EQ(points_with("returnStatus", "-1", "2"), 7);
  EXPECT_EQ(points_with("returnStatus", "1", "2"), 8);
  EXPECT_EQ(points_with("found", "-3", "5"), 8);
  EXPECT_EQ(points_with("found", "-3", "5", ", status: found"), 7);
  EXPECT_EQ(points_with("found", "", "5", ", status: found"), 7);
  EXPECT_EQ(points_with("STATUS_FLAG", "5", "4", ", status: STATUS_FLAG"), 7);
}

TEST_F(DisplacementTable, NamesAFileWhosePointsAreOthers) {
  folder_.Write("f/a.txt", Rows(0, 8, 0));
  folder_.Write("f/b.txt", Rows(20, 28, 0));
  const Recording others = Load(Yaml("  {kind: points, files: f/*.txt, rate: 1 Hz}\n"));
  EXPECT_THAT(ErrorOf([&] { LoadFrame(others, 1); }), HasSubstr("b.txt: has none of the points"));
  const std::string twice = Rows(0, 8, 0) + "3;1;1;1;0;0;0\n";
  folder_.Write("f/b.txt", twice);
  EXPECT_THAT(ErrorOf([&] { LoadFrame(others, 1); }), HasSubstr("b.txt: lists the point 3 twice"));
}

TEST_F(DisplacementTable, OfMatchIdHasItsLongNames) {
  DelimitedTable table = Table(
      "Coordinates.Image X [Pixel],Coordinates.Image Y [Pixel],coor.X [mm],coor.Y [mm],coor.Z [mm],"
      "disp.Horizontal Displacement U [mm],disp.Vertical Displacement V [mm],"
      "disp.Out-Of-Plane: W [mm],strain.Strain-global frame: Exx [ ]\n"
      "100,200,1,2,3,0.5,-0.5,0.25,0.001\n101,200,2,2,3,0.5,,0.25,0.001\n");
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  ASSERT_TRUE(columns.has_value());
  EXPECT_EQ(columns->length_unit, "mm");
  EXPECT_FALSE(columns->has_common_names);
  const Eigen::Matrix3Xd points = MovedPoints(table, *columns);
  EXPECT_EQ(points.col(0), Eigen::Vector3d(1.5, 1.5, 3.25));
  EXPECT_FALSE(points.col(1).allFinite());
  DelimitedTable plane = Table(
      "coor.X [mm],coor.Y [mm],disp.Horizontal Displacement U [mm],"
      "disp.Vertical Displacement V [mm]\n1,2,3,4\n");
  EXPECT_THAT(ErrorOf([&] { FindDisplacementColumns(&plane); }),
              HasSubstr("in the image plane only (\"disp.Horizontal Displacement U [mm]\""));
}

TEST_F(DisplacementTable, MayHaveATitleUnitsAndDecimalCommas) {
  DelimitedTable table = Table(
      "Blade_2 AOI 2\n\"Index [1]\";\"X [mm]\";\"Y [mm]\";\"Z [mm]\";\"U [mm]\";\"V [mm]\";"
      "\"W [mm]\";\"Sigma_X [mm]\";\"sigma [pixel]\"\n"
      "1;1,5;2;3;0,5;0;-1;0,1;0,02\n2;1;2;3;0;0;0;0,1;-1\n");
  const std::optional<DisplacementColumns> columns = FindDisplacementColumns(&table);
  ASSERT_TRUE(columns.has_value());
  EXPECT_EQ(columns->length_unit, "mm");
  EXPECT_EQ(columns->id, 0);
  EXPECT_EQ(MovedPoints(table, *columns).col(0), Eigen::Vector3d(2, 2, 2));
  EXPECT_EQ(SigmaOf(table, *columns), Eigen::Vector2d(0.02, -1));
}

TEST_F(DisplacementTable, OfSimulatedNodemapsHasOtherNames) {
  EXPECT_EQ(Moved(Table("#   index   ;    x_undf  ;    y_undf  ;    z_undf  ;    ux      ;    uy   "
                        "   ;    uz      ;    eps_x\n     1.00000;     30.00000;     0.00000;     "
                        "0.00000;     -0.5;     0.25;     1.00000;    -0.03577\n"))
                .col(0),
            Eigen::Vector3d(29.5, 0.25, 1));
}

TEST_F(DisplacementTable, GivesTheDeviationOfEachPoint) {
  folder_.Write("f/a.csv",
                "X,Y,Z,U,V,W,sigma,id\n0,0,0,0,0,0,0.1,1\n1,0,1,0,0,0,0.2,2\n"
                "0,1,2,0,0,0,-1,3\n1,1,0,0,0,0,0.3,4\n2,1,0,0,0,0,0.4,5\n");
  folder_.Write("f/b.csv",
                "X,Y,Z,U,V,W,sigma,id\n2,1,0,0,0,0,0.8,5\n0,0,0,1,0,0,0.5,1\n"
                "1,1,0,0,0,0,0.6,4\n1,0,1,0,0,0,0.7,2\n");
  const Recording recording = Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n"));
  const Frame first = LoadFrame(recording, 0), second = LoadFrame(recording, 1);
  EXPECT_EQ(first.sigma, Eigen::Vector4d(0.1, 0.2, 0.3, 0.4)) << "the failed point is left out";
  EXPECT_EQ(second.sigma, Eigen::Vector4d(0.5, 0.7, 0.6, 0.8)) << "by the points' numbers";
}

// Points of a grid without numbers, displaced by 7 along x; `lost` is not in the file.
std::string Grid(int lost, double u, double noise = 0) {
  std::string text = "X,Y,Z,U,V,W,sigma\n";
  for (int i = 0; i < 12; ++i)
    if (i != lost)
      text += std::to_string(10 * (i % 4) + noise * (i % 3)) + "," + std::to_string(10 * (i / 4)) +
              "," + std::to_string(i * 5 % 3) + "," + std::to_string(u) + ",0,0,0.1\n";
  return text;
}

TEST_F(DisplacementTable, WithoutNumbersIdentifiesPointsByTheirPlaces) {
  folder_.Write("f/a.csv", Grid(9, 0));
  folder_.Write("f/b.csv", Grid(2, 7));  // as many rows, which are others
  folder_.Write("f/c.csv", Grid(-1, 7));
  folder_.Write("f/d.csv", Grid(9, 7, 0.01));  // places with a little noise
  const Recording recording = Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n"));
  const Frame first = LoadFrame(recording, 0);
  ASSERT_EQ(first.cloud.Size(), 11);
  for (const int i : {1, 2, 3}) {
    const Frame frame = LoadFrame(recording, i);
    EXPECT_EQ(frame.row_count, 11);
    ASSERT_EQ(frame.cloud.Size(), i == 1 ? 10 : 11);
    for (Eigen::Index k = 0; k < frame.cloud.Size(); ++k) {
      const Eigen::Vector3d moved =
          frame.cloud.points.col(k) - first.cloud.points.col(frame.source_row[k]);
      EXPECT_LT((moved - Eigen::Vector3d(0.007, 0, 0)).norm(), 1e-4) << i << ", row " << k;
    }
  }
}

TEST_F(DisplacementTable, WithoutNumbersIsRefusedWhereNoPlaceIsKnown) {
  folder_.Write("f/a.csv", Grid(-1, 0));
  std::string text = "X,Y,Z,U,V,W,sigma\n";
  for (int i = 0; i < 6; ++i) text += "500," + std::to_string(10 * i) + ",1,0,0,0,0.1\n";
  folder_.Write("f/b.csv", text);
  const Recording others = Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n"));
  EXPECT_THAT(ErrorOf([&] { LoadFrame(others, 1); }),
              HasSubstr("b.csv: has no point at a place of the first file"));
}

TEST_F(DisplacementTable, ComparesTheUnitsOfColumnsThatAreNamed) {
  const std::string cloud = Cloud(12);
  folder_.Write("a.csv", "a [m],b [m],c [m]\n" + cloud);
  folder_.Write("b.csv", "a (left),b (left),c (left)\n" + cloud);
  const auto warnings = [&](const std::string& file, const std::string& unit) {
    const std::string column = " " + unit + "\"";
    return Load(Yaml("  {kind: points, files: [" + file + "], columns: {x: \"a" + column +
                     ", y: \"b" + column + ", z: \"c" + column + "}}\n"))
        .warnings;
  };
  EXPECT_THAT(warnings("a.csv", "[m]"), ElementsAre(HasSubstr("lengths are in m; recording.yaml")));
  EXPECT_THAT(warnings("b.csv", "(left)"), IsEmpty()) << "no unit";
}

TEST_F(DisplacementTable, RefusesANameThatTwoColumnsHave) {
  DelimitedTable table = Table("X,Y,Z,U,V,W,U\n1,2,3,0,0,0,9\n");
  EXPECT_THAT(ErrorOf([&] { FindDisplacementColumns(&table); }),
              HasSubstr("has the columns \"U\" and \"U\", of which the numbers are 4 and 7"));
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
  EXPECT_THAT(LoadError(yaml("  header: {time: force}\n", "")), HasSubstr("does not follow"));
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

TEST_F(DisplacementTable, WhosePlacesMoveWithTheDisplacementsIsDoubted) {
  const auto write = [&](const std::string& name, double place, double u) {
    std::string text = "a,b,c,da,db,dc\n";
    for (int i = 0; i < 8; ++i)
      text += std::to_string(10 * i + place) + "," + std::to_string(i * 7 % 11) + "," +
              std::to_string(i * 5 % 3) + "," + std::to_string(u) + ",0,0\n";
    folder_.Write(name, text);
  };
  write("f/a.csv", 0, 0);
  write("f/b.csv", 1, 1);
  const std::string columns = "columns: {x: a, y: b, z: c, u: da, v: db, w: dc";
  const auto warnings = [&](const std::string& more) {
    return Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz, " + columns + more + "}}\n"))
        .warnings;
  };
  EXPECT_THAT(warnings(""), ElementsAre(HasSubstr("unless `columns` says `places: deformed`")));
  EXPECT_THAT(warnings(", places: deformed"), IsEmpty());
  write("f/b.csv", 0, 1);
  EXPECT_THAT(warnings(""), IsEmpty());
  EXPECT_THAT(warnings(", places: deformed"),
              ElementsAre(HasSubstr("they are those of the reference state")));
}

}  // namespace
}  // namespace lacuna
