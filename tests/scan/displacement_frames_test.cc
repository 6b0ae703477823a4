// Tables of image correlation as the frames of a recording: which point a row is, and its quality.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "scan/displacement_table_fixture.h"
#include "scan/recording.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

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

TEST_F(DisplacementTable, NamesAFileWhosePointsAreOthers) {
  folder_.Write("f/a.txt", Rows(0, 8, 0));
  folder_.Write("f/b.txt", Rows(20, 28, 0));
  const Recording others = Load(Yaml("  {kind: points, files: f/*.txt, rate: 1 Hz}\n"));
  EXPECT_THAT(ErrorOf([&] { LoadFrame(others, 1); }), HasSubstr("b.txt: has none of the points"));
  const std::string twice = Rows(0, 8, 0) + "3;1;1;1;0;0;0\n";
  folder_.Write("f/b.txt", twice);
  EXPECT_THAT(ErrorOf([&] { LoadFrame(others, 1); }), HasSubstr("b.txt: lists the point 3 twice"));
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
              HasSubstr("b.csv: has no point at a position of the first file"));
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
              ElementsAre(HasSubstr("they are probably those of the reference state")));
}

}  // namespace
}  // namespace lacuna
