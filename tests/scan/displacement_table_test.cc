#include "scan/displacement_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "scan/recording_fixture.h"

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

TEST_F(DisplacementTable, NamesAFileWhosePointsAreOthers) {
  folder_.Write("f/a.txt", Rows(0, 8, 0));
  folder_.Write("f/b.txt", Rows(20, 28, 0));
  const Recording others = Load(Yaml("  {kind: points, files: f/*.txt, rate: 1 Hz}\n"));
  EXPECT_THAT(ErrorOf([&] { LoadFrame(others, 1); }), HasSubstr("b.txt: has none of the points"));
  const std::string twice = Rows(0, 8, 0) + "3;1;1;1;0;0;0\n";
  folder_.Write("f/b.txt", twice);
  EXPECT_THAT(ErrorOf([&] { LoadFrame(others, 1); }), HasSubstr("b.txt: lists the point 3 twice"));
}

}  // namespace
}  // namespace lacuna
