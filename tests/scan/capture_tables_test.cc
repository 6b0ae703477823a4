#include "scan/capture_tables.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "scan/marker_files.h"
#include "scan/test_files.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

// `rows`: behind the header. `columns`: the line with the names of the columns, with its end.
std::string Qualisys(const std::string& rows, const std::string& frames,
                     const std::string& columns = "") {
  return "NO_OF_FRAMES\t" + frames +
         "\r\nNO_OF_CAMERAS\t8\r\nNO_OF_MARKERS\t2\r\nFREQUENCY\t200\r\nDESCRIPTION\t--\r\n"
         "TIME_STAMP\t2024-05-01, 10:00:00\t12.5\r\nDATA_INCLUDED\t3D\r\n"
         "MARKER_NAMES\ttip\tbase left\t\r\nTRAJECTORY_TYPES\tMeasured\tMeasured\r\n" +
         columns + rows;
}

TEST(QualisysTsv, ReadsFramesTimesAndGaps) {
  const TestFolder folder;
  const MarkerTracks tracks = ReadMarkerTracks(
      folder.Write("a.tsv", Qualisys("1\t0.00000\t1\t2\t3\t4\t5\t6\r\n2\t0.00500\t1.5\t2\t3\t0.000"
                                     "\t0.000\t0.000\r\n3\t0.01000\tNULL\tNULL\tNULL\t4\t5\t7\r\n",
                                     "3", "Frame\tTime\ttip X\ttip Y\ttip Z\tb X\tb Y\tb Z\r\n")),
      {});
  EXPECT_THAT(tracks.names, ElementsAre("tip", "base left"));
  EXPECT_EQ(tracks.length_unit, "mm");
  ASSERT_EQ(tracks.positions.size(), 3u);
  EXPECT_EQ(tracks.positions[0].col(1), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(tracks.positions[1].col(0), Eigen::Vector3d(1.5, 2, 3));
  EXPECT_TRUE(tracks.positions[1].col(1).array().isNaN().all());
  EXPECT_TRUE(tracks.positions[2].col(0).array().isNaN().all());
  EXPECT_DOUBLE_EQ(tracks.times[1], 0.005);
}

TEST(QualisysTsv, TakesTimesFromTheFrequencyWhereItHasNone) {
  const TestFolder folder;
  const std::string rows = "\t\t\t4\t5\t6\t\n1\t2\t3.5\t4\t5\t6\t\n\t\t\t\t\t\t\n\n";
  const MarkerTracks tracks = ReadMarkerTracks(folder.Write("a.tsv", Qualisys(rows, "3")), {});
  ASSERT_EQ(tracks.positions.size(), 3u);
  EXPECT_TRUE(tracks.positions[0].col(0).array().isNaN().all()) << "a gap at the start of a row";
  EXPECT_TRUE(tracks.positions[2].array().isNaN().all()) << "a frame without any marker";
  EXPECT_EQ(tracks.positions[1].col(0), Eigen::Vector3d(1, 2, 3.5));
  EXPECT_DOUBLE_EQ(tracks.times[1], 0.005);
  const MarkerTracks replaced = ReadMarkerTracks(folder.Path() / "a.tsv", {}, FileTimes::kReplaced);
  EXPECT_EQ(replaced.times.size(), 3) << "for a comparison";
}

TEST(QualisysTsv, WarnsOfTimesThatContradictTheFrequency) {
  const TestFolder folder;
  const auto warnings = [&](double interval) {
    std::string rows;
    for (int k = 0; k < 40; ++k)
      rows += fmt::format("{}\t{:.5f}\t1\t2\t3\t4\t5\t6\n", k, k * interval);
    const std::string names = "Frame\tTime\ttip X\ttip Y\ttip Z\tb X\tb Y\tb Z\n";
    return ReadMarkerTracks(folder.Write("a.tsv", Qualisys(rows, "40", names)), {}).warnings;
  };
  EXPECT_THAT(warnings(0.005), IsEmpty());
  EXPECT_THAT(warnings(0.1), ElementsAre(HasSubstr("its header states 200 Hz, but its times follow "
                                                   "each other at 10 Hz")));
}

TEST(QualisysTsv, RefusesWhatDoesNotFitItsHeader) {
  const TestFolder folder;
  const auto message = [&](const std::string& content) {
    const auto file = folder.Write("bad.tsv", content);
    return ErrorOf([&] { ReadMarkerTracks(file, {}); });
  };
  EXPECT_THAT(message(Qualisys("1\t2\t3\t4\t5\t6\n", "2")),
              HasSubstr("bad.tsv: holds 1 frames where NO_OF_FRAMES says 2"));
  EXPECT_THAT(message(Qualisys("1\t2\t3\t4\t5\t6\n1\t2\t3\n", "2")),
              HasSubstr("bad.tsv:11:1: has 3 entries; expected 6 for 2 markers"));
  EXPECT_THAT(message(Qualisys("1\t2\tq\t4\t5\t6\n", "1")), HasSubstr("bad.tsv:10:5: got \"q\""));
  EXPECT_THAT(message("NO_OF_FRAMES\t1\nDATA_INCLUDED\t2D\n1\t2\n"),
              HasSubstr("bad.tsv:2:1: holds 2D data"));
  EXPECT_THAT(message("NO_OF_FRAMES\t1\n1\t2\t3\n"), HasSubstr("names no markers"));
  EXPECT_THAT(message(Qualisys("", "0")), HasSubstr("bad.tsv: holds no frame"));
}

// The empty entries of the last marker must not be taken for tabs at the end of the row: frame and
// time would become coordinates.
TEST(QualisysTsv, FindsTheCoordinatesWhereTheLastMarkerIsUnseenAtFirst) {
  const TestFolder folder;
  for (const char* end : {"", "\t"}) {
    const std::string rows =
        fmt::format("1\t0.000\t1\t2\t3\t\t\t{0}\n2\t0.005\t1\t2\t3\t4\t5\t6{0}\n", end);
    const MarkerTracks tracks = ReadMarkerTracks(folder.Write("a.tsv", Qualisys(rows, "2")), {});
    ASSERT_EQ(tracks.positions.size(), 2u);
    EXPECT_EQ(tracks.positions[0].col(0), Eigen::Vector3d(1, 2, 3));
    EXPECT_TRUE(tracks.positions[0].col(1).array().isNaN().all());
    EXPECT_EQ(tracks.positions[1].col(1), Eigen::Vector3d(4, 5, 6));
  }
}

const std::string kMotive =
    "Format Version,1.23,Take Name,\"bend, slow\",Capture Frame Rate,120.000000,Export Frame "
    "Rate,120.000000,Length Units,Centimeters,Coordinate Space,Global\n\n"
    ",Type,Rigid Body,Rigid Body,Rigid Body,Marker,Marker,Marker,Marker,Marker,Marker\n"
    ",Name,\"clamp\",\"clamp\",\"clamp\",\"arm:tip\",\"arm:tip\",\"arm:tip\",u 1,u 1,u 1\n"
    ",ID,1,1,1,\"A,1\",\"A,1\",\"A,1\",B,B,B\n"
    ",,Position,Position,Position,Position,Position,Position,Position,Position,Position\n"
    "Frame,Time (Seconds),X,Y,Z,X,Y,Z,X,Y,Z\n";

TEST(MotiveCsv, ReadsTheMeasuredMarkers) {
  const TestFolder folder;
  const MarkerTracks tracks = ReadMarkerTracks(
      folder.Write("a.csv", kMotive + "0,0.000000,9,9,9,1,2,3,4,5,6\n"
                                      "1,0.008333,9,9,9,1,2,3.5,,,\n2,0.016667,9,9,9,1,2,4\n"),
      {});
  EXPECT_THAT(tracks.names, ElementsAre("arm:tip", "u 1"));
  EXPECT_EQ(tracks.length_unit, "cm");
  EXPECT_THAT(tracks.warnings, IsEmpty());
  ASSERT_EQ(tracks.positions.size(), 3u);
  EXPECT_EQ(tracks.positions[0].col(1), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(tracks.positions[1].col(0), Eigen::Vector3d(1, 2, 3.5));
  for (const size_t gap : {1, 2})
    EXPECT_TRUE(tracks.positions[gap].col(1).array().isNaN().all()) << gap;
  EXPECT_DOUBLE_EQ(tracks.times[2], 0.016667);
}

TEST(MotiveCsv, ReadsOlderHeadersAndNumbersNamesThatRepeat) {
  const TestFolder folder;
  const MarkerTracks tracks =
      ReadMarkerTracks(folder.Write("a.csv",
                                    "Format Version,1.2,Take Name,a,Capture Frame Rate,100\n\n"
                                    ",,Marker,Marker,Marker,Marker,Marker,Marker\n,,u,u,u,u,u,u\n"
                                    ",,Position,Position,Position,Position,Position,Position\n"
                                    "Frame,Time,X,Y,Z,X,Y,Z\n0,0,1,2,3,,,\n1,0.01,,,,4,5,6\n"),
                       {});
  EXPECT_THAT(tracks.names, ElementsAre("u", "u (2)"));
  EXPECT_THAT(tracks.warnings, ElementsAre(HasSubstr("several markers are called u;")));
  EXPECT_EQ(tracks.positions[1].col(1), Eigen::Vector3d(4, 5, 6));
}

TEST(MotiveCsv, RefusesWhatItCannotUse) {
  const TestFolder folder;
  const auto message = [&](const std::string& content) {
    const auto file = folder.Write("bad.csv", content);
    return ErrorOf([&] { ReadMarkerTracks(file, {}); });
  };
  EXPECT_THAT(message("Format Version,1.23\n\n1,2,3\n"), HasSubstr("bad.csv: has no rows"));
  EXPECT_THAT(message("Format Version,1.23\n\n,Type,Bone,Bone,Bone\n,Name,b,b,b\n"
                      ",,Position,Position,Position\nFrame,Time,X,Y,Z\n0,0,1,2,3\n"),
              HasSubstr("no columns of the type Marker"));
  EXPECT_THAT(message(kMotive), HasSubstr("bad.csv: holds no frame"));
  EXPECT_THAT(message(kMotive + "0,0,9,9,9,1,q,3,4,5,6\n"), HasSubstr("bad.csv:8:13: got \"q\""));
  EXPECT_THAT(message(kMotive + "0,0,9,9,9,1,2,3,4,5,6\n1,0,9,9,9,1,2,3,4,5,6\n"),
              HasSubstr("is not later than that of the frame before"));
  EXPECT_THAT(message(kMotive + "0,0,9,9,9,1,2,3,4,5,6,7\n"), HasSubstr("has 12 entries"));
}

TEST(DeepLabCutCsv, GivesPointsInSpaceByBodyPart) {
  const TestFolder folder;
  const MarkerTracks tracks =
      ReadMarkerTracks(folder.Write("a.csv",
                                    "scorer,DLC,DLC,DLC,DLC,DLC,DLC,DLC\n"
                                    "bodyparts,tip,tip,tip,tip,base,base,base\n"
                                    "coords,x,y,z,likelihood,x,y,z\n"
                                    "0,1,2,3,0.9,4,5,6\n1,1.5,2,3,0.9,,,\n"),
                       {});
  EXPECT_THAT(tracks.names, ElementsAre("tip", "base"));
  EXPECT_EQ(tracks.times.size(), 0);
  ASSERT_EQ(tracks.positions.size(), 2u);
  EXPECT_EQ(tracks.positions[0].col(1), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(tracks.positions[1].col(0), Eigen::Vector3d(1.5, 2, 3));
  EXPECT_TRUE(tracks.positions[1].col(1).array().isNaN().all());
  const MarkerTracks two = ReadMarkerTracks(
      folder.Write("b.csv",
                   "scorer,DLC,DLC,DLC,DLC,DLC,DLC\nindividuals,left,left,left,right,right,"
                   "right\nbodyparts,tip,tip,tip,tip,tip,tip\ncoords,x,y,z,x,y,z\n"
                   "0,1,2,3,4,5,6\n"),
      {});
  EXPECT_THAT(two.names, ElementsAre("left tip", "right tip"));
}

TEST(DeepLabCutCsv, OfOneCameraIsRefusedWithItsReason) {
  const TestFolder folder;
  const auto message = [&](const std::string& content) {
    return ErrorOf([&] { ReadMarkerTracks(folder.Write("a.csv", content), {}); });
  };
  EXPECT_THAT(
      message("scorer,DLC,DLC,DLC\nbodyparts,tip,tip,tip\ncoords,x,y,likelihood\n0,1,2,1\n"),
      HasSubstr("x and y only, which are pixels of one camera; triangulate"));
  EXPECT_THAT(message("scorer,DLC,DLC,DLC\nbodyparts,tip,tip,tip\n0,1,2,1\n"),
              HasSubstr("has no rows bodyparts and coords"));
  EXPECT_THAT(message("scorer,DLC,DLC,DLC\nbodyparts,tip,tip,tip\ncoords,x,y,z\n0,1,2,b\n"),
              HasSubstr("a.csv:4:7: got \"b\"; expected a number"));
  EXPECT_THAT(message("scorer,DLC,DLC,DLC\nbodyparts,tip,tip,tip\ncoords,x,y,z\n"),
              HasSubstr("holds no frame"));
}

// Anipose writes a CSV whose columns are named like those of other programs.
TEST(AniposeCsv, IsReadWithoutNamingItsColumns) {
  const TestFolder folder;
  const MarkerTracks tracks = ReadMarkerTracks(
      folder.Write("a.csv",
                   "l-base_x,l-base_y,l-base_z,l-base_error,l-base_ncams,l-base_score,"
                   "tip_x,tip_y,tip_z,tip_error,tip_ncams,tip_score,M_00,M_01,center_0,fnum\n"
                   "1,2,3,0.5,2,0.9,4,5,6,0.5,3,0.9,1,0,0,0\n"
                   "1,2,3,0.5,2,0.9,,,,,,,1,0,0,1\n"),
      {});
  EXPECT_THAT(tracks.names, ElementsAre("l-base", "tip"));
  ASSERT_EQ(tracks.positions.size(), 2u);
  EXPECT_EQ(tracks.positions[0].col(1), Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(tracks.positions[1].col(1).array().isNaN().all());
}

}  // namespace
}  // namespace lacuna
