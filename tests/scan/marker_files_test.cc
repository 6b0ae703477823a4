// Markers in text tables and TRC files; c3d_test.cc has the binary files.
#include "scan/marker_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "scan/test_files.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

TEST(MarkerCsv, FindsMarkersByTheirColumns) {
  const TestFolder folder;
  const auto file = folder.Write("a.csv",
                                 "t_s,tip_x,tip_y,tip_z,base_x,base_y,base_z,force\n"
                                 "0.0,1,2,3,4,5,6,9\n0.1,1,2,3,,nan,,9\n");
  MarkerColumns columns;
  columns.time = "t_s";
  const MarkerTracks tracks = ReadMarkerTracks(file, columns);
  EXPECT_THAT(tracks.names, ElementsAre("tip", "base"));
  EXPECT_EQ(tracks.positions[0].col(1), Eigen::Vector3d(4, 5, 6));
  EXPECT_TRUE(tracks.positions[1].col(1).array().isNaN().all());
  EXPECT_DOUBLE_EQ(tracks.times[1], 0.1);
  const MarkerTracks selected = SelectMarkers(tracks, {"base"}, file);
  EXPECT_EQ(selected.positions[0].col(0), Eigen::Vector3d(4, 5, 6));
  EXPECT_THAT(ErrorOf([&] { SelectMarkers(tracks, {"tap"}, file); }),
              HasSubstr("has no marker \"tap\"; its markers are tip, base"));
}

TEST(MarkerCsv, RefusesMissingColumnsAndDecreasingTimes) {
  const TestFolder folder;
  MarkerColumns columns;
  const auto half = folder.Write("half.csv", "tip_x,tip_y\n1,2\n");
  EXPECT_THAT(ErrorOf([&] { ReadMarkerCsv(half, columns); }), HasSubstr("no column \"tip_z\""));
  const auto none = folder.Write("none.csv", "a,b,c\n1,2,3\n");
  EXPECT_THAT(ErrorOf([&] { ReadMarkerCsv(none, columns); }),
              HasSubstr("no column matches \"*_x\"; its columns are a, b, c"));
  const auto back = folder.Write("back.csv", "t,a_x,a_y,a_z\n0,1,2,3\n0,1,2,3\n");
  columns.time = "t";
  EXPECT_THAT(ErrorOf([&] { ReadMarkerCsv(back, columns); }), HasSubstr("frame 1: the time 0 s"));
}

TEST(MarkerCsv, RefusesColumnsOfTheSameName) {
  const TestFolder folder;
  const auto file = folder.Write("a.csv", "a_x,a_y,a_z,a_x,a_y,a_z\n1,2,3,4,5,6\n");
  EXPECT_THAT(ErrorOf([&] { ReadMarkerCsv(file, {}); }), HasSubstr("has several columns \"a_x\""));
}

TEST(MarkerCsv, FindsNamesInAnyCase) {
  const TestFolder folder;
  const auto file = folder.Write("a.csv", "Tip_X,Tip_Y,Tip_Z\n1,2,3\n");
  const MarkerTracks tracks = ReadMarkerCsv(file, {});
  EXPECT_THAT(tracks.names, ElementsAre("Tip"));
  EXPECT_EQ(tracks.positions[0].col(0), Eigen::Vector3d(1, 2, 3));
  const auto both = folder.Write("b.csv", "a_x,a_y,a_z,b_X,b_Y,b_Z\n1,2,3,4,5,6\n");
  EXPECT_THAT(ReadMarkerCsv(both, {}).names, ElementsAre("a")) << "an exact fit comes first";
}

TEST(MarkerCsv, HasTimesInTheirUnit) {
  const TestFolder folder;
  const auto file = folder.Write("a.csv", "time [ms],a_x,a_y,a_z\n0,1,2,3\n10,1,2,3\n");
  MarkerColumns columns;
  columns.time = "time [ms]";
  EXPECT_THAT(ErrorOf([&] { ReadMarkerCsv(file, columns); }),
              HasSubstr("a.csv: has a column \"time [ms]\", but its values are read in another "
                        "unit; say `time_unit: ms`"));
  columns.time_unit = 1e-3;
  EXPECT_DOUBLE_EQ(ReadMarkerCsv(file, columns).times[1], 0.01);
}

// `rate` in recording.yaml replaces the times.
TEST(MarkerCsv, KeepsTimesThatAreReplacedForAComparison) {
  const TestFolder folder;
  MarkerColumns columns;
  columns.time = "t";
  const auto read = [&](const char* rows) {
    const auto file = folder.Write("a.csv", std::string("t,a_x,a_y,a_z\n") + rows);
    return ReadMarkerCsv(file, columns, FileTimes::kReplaced).times;
  };
  EXPECT_EQ(read("0,1,2,3\n0.1,1,2,3\n"), Eigen::Vector2d(0, 0.1));
  EXPECT_EQ(read("0,1,2,3\n0,1,2,3\n").size(), 0);
}

TEST(MarkerCsv, WithoutALineOfNamesSaysSo) {
  const TestFolder folder;
  const auto file = folder.Write("a.csv", "0,1,2,3\n1,1,2,3\n");
  EXPECT_THAT(ErrorOf([&] { ReadMarkerCsv(file, {}); }),
              HasSubstr("a.csv:1:1: has no line with the names of the columns, such as tip_x"));
}

std::string MakeTrc(const std::string& frames, const std::string& markers) {
  return "PathFileType\t4\t(X/Y/Z)\twalk.trc\n"
         "DataRate\tCameraRate\tNumFrames\tNumMarkers\tUnits\n100\t100\t" +
         frames + "\t" + markers +
         "\tmm\nFrame#\tTime\tLeft\t\t\tRight\t\t\n\t\tX1\tY1\tZ1\tX2\tY2\tZ2\n\n"
         "1\t0.00\t1\t2\t3\t4\t5\t6\r\n2\t0.01\t1.5\t2\t3\t\t\t\r\n3\t0.02\t1.5\t2\t3\n";
}

TEST(Trc, ReadsMarkersTimesAndGaps) {
  const TestFolder folder;
  const MarkerTracks tracks = ReadMarkerTracks(folder.Write("a.trc", MakeTrc("3", "2")), {});
  EXPECT_THAT(tracks.names, ElementsAre("Left", "Right"));
  EXPECT_EQ(tracks.length_unit, "mm");
  ASSERT_EQ(tracks.positions.size(), 3u);
  EXPECT_EQ(tracks.positions[0].col(1), Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(tracks.positions[1].col(0), Eigen::Vector3d(1.5, 2, 3));
  EXPECT_TRUE(tracks.positions[1].col(1).array().isNaN().all());
  EXPECT_TRUE(tracks.positions[2].col(1).array().isNaN().all());
  EXPECT_DOUBLE_EQ(tracks.times[2], 0.02);
}

TEST(Trc, ReadsDecimalCommas) {
  const TestFolder folder;
  std::string content = MakeTrc("3", "2");
  for (size_t at = content.find("1\t0.00"); (at = content.find('.', at)) != std::string::npos;)
    content[at] = ',';
  const MarkerTracks tracks = ReadTrc(folder.Write("a.trc", content));
  EXPECT_EQ(tracks.positions[1].col(0), Eigen::Vector3d(1.5, 2, 3));
  EXPECT_DOUBLE_EQ(tracks.times[2], 0.02);
}

TEST(Trc, NumbersNamesThatRepeat) {
  const TestFolder folder;
  std::string content = MakeTrc("3", "2");
  content.replace(content.find("Right"), 5, "Left");
  const MarkerTracks tracks = ReadTrc(folder.Write("a.trc", content));
  EXPECT_THAT(tracks.names, ElementsAre("Left", "Left (2)"));
  EXPECT_THAT(tracks.warnings, ElementsAre(HasSubstr("a.trc: several markers are called Left")));
}

TEST(Trc, RefusesContradictoryCounts) {
  const TestFolder folder;
  const auto message = [&](const std::string& content) {
    const auto file = folder.Write("bad.trc", content);
    return ErrorOf([&] { ReadTrc(file); });
  };
  EXPECT_THAT(message(MakeTrc("4", "2")),
              HasSubstr("bad.trc: holds 3 frames where NumFrames says 4"));
  EXPECT_THAT(message(MakeTrc("3", "3")), HasSubstr("bad.trc:4:1: names 2 markers"));
  EXPECT_THAT(message(MakeTrc("x", "2")), HasSubstr("NumFrames: got \"x\""));
  EXPECT_THAT(message("hello\n"), HasSubstr("is not a TRC file"));
  std::string blanks = MakeTrc("3", "2");
  std::replace(blanks.begin(), blanks.end(), '\t', ' ');
  EXPECT_THAT(message(blanks), HasSubstr("bad.trc:2:1: has no tabs"));
  EXPECT_THAT(message(MakeTrc("3", "2") + "4\t0.03\tq\n"), HasSubstr("bad.trc:10:8: got \"q\""));
}

TEST(Trc, TimesThatAreReplacedMayBeEqual) {
  const TestFolder folder;
  std::string content = MakeTrc("3", "2");
  content.replace(content.find("0.01"), 4, "0.00");
  const auto file = folder.Write("a.trc", content);
  EXPECT_THAT(
      ErrorOf([&] { ReadTrc(file); }),
      HasSubstr("a.trc: frame 1: the time 0 s is not later than that of the frame before, perhaps "
                "because it was rounded; the file states 100 Hz: `rate: 100 Hz` in "
                "recording.yaml replaces its times"));
  const MarkerTracks tracks = ReadTrc(file, FileTimes::kReplaced);
  EXPECT_EQ(tracks.positions.size(), 3u);
  EXPECT_EQ(tracks.times.size(), 0);
}

TEST(Trc, AByteOrderMarkIsRead) {
  const TestFolder folder;
  EXPECT_EQ(ReadTrc(folder.Write("a.trc", "\xef\xbb\xbf" + MakeTrc("3", "2"))).names[0], "Left");
}

}  // namespace
}  // namespace lacuna
