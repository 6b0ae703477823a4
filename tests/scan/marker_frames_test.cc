#include "scan/marker_frames.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "geometry/mesh_io.h"
#include "scan/recording_fixture.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::Contains;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

TEST_F(RecordingTest, LoadsMarkersWithGapsAndFollowsThem) {
  folder_.Write("m.csv",
                "t,a_x,a_y,a_z,b_x,b_y,b_z,c_x,c_y,c_z\n0.5,0,0,0,50,0,0,90,9,9\n"
                "0.6,0,0,0,nan,nan,nan,90,9,9\n0.7,,,,,,,,,\n");
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  const std::string frames =
      "  {kind: markers, file: m.csv, columns: {time: t}, markers: [b, a],\n"
      "   marker_places: [{name: a, position: [0, 0, 1 mm]}]}\n";
  const std::string reference = "reference: {from: mesh, file: box.ply, length_unit: m}\n";
  const Recording recording =
      Load(Yaml(frames, reference + "gripped: [{nodes: [1], follows_markers: [a]}]\n"));
  EXPECT_THAT(recording.times, ElementsAre(0.5, 0.6, 0.7));
  EXPECT_DOUBLE_EQ(LoadFrame(recording, 0).cloud.points(0, 0), 0.05);
  const Frame second = LoadFrame(recording, 1);
  EXPECT_EQ(second.source_row, Eigen::VectorXi::Constant(1, 1));
  EXPECT_EQ(second.dropped_count, 1);
  EXPECT_EQ(recording.markers.places.col(1), Eigen::Vector3d(0, 0, 1e-3));
  EXPECT_TRUE(std::isnan(recording.markers.places(0, 0)));
  EXPECT_THAT(ErrorOf([&] { LoadFrame(recording, 2); }),
              HasSubstr("m.csv: none of its 2 points is finite"));
  EXPECT_THAT(LoadError(Yaml(frames)), HasSubstr("the frames do not show the surface"));
  EXPECT_THAT(
      LoadError(Yaml(frames, reference + "gripped: [{nodes: [1], follows_markers: [d]}]\n")),
      HasSubstr(
          "gripped[0].follows_markers: the recording has no marker \"d\"; its markers are b, a"));
  std::string twice = frames;
  twice.insert(twice.find("{name: a,"), "{name: a, position: [0, 0, 2 mm]}, ");
  EXPECT_THAT(LoadError(Yaml(twice, reference)),
              HasSubstr("marker_places[1].name: is listed twice"));
  folder_.Write("m.csv", "t,a_x,a_y,a_z,b_x,b_y,b_z\n0.5,0,0,0,50,0,0\n0.6,0,1e300,0,0,0,0\n");
  EXPECT_THAT(LoadError(Yaml(frames, reference)),
              HasSubstr("m.csv: frame 1: marker a is 1e+297 m away"));
}

TEST_F(RecordingTest, ReadsThePlacesOfMarkersFromATable) {
  folder_.Write("m.csv", "t,a_x,a_y,a_z,b_x,b_y,b_z\n0.5,0,0,0,50,0,0\n0.6,1,0,0,50,1,0\n");
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  const std::string frames =
      "  {kind: markers, file: m.csv, columns: {time: t}, markers: [b],\n"
      "   marker_places_file: places.csv}\n";
  const std::string reference = "reference: {from: mesh, file: box.ply, length_unit: m}\n";
  const auto error = [&](const std::string& table) {
    folder_.Write("places.csv", table);
    return LoadError(Yaml(frames, reference));
  };
  folder_.Write("places.csv",
                "\"Name\";Z;X;Y;glue\n# of the drawing\nb;3,5;1;-2;yes\n\nc;0;0;0;\n");
  const Recording recording = Load(Yaml(frames, reference));
  EXPECT_TRUE(recording.markers.places.isApprox(Eigen::Vector3d(1e-3, -2e-3, 3.5e-3), 1e-12))
      << recording.markers.places;
  EXPECT_THAT(recording.files, Contains(StateOf(folder_.Path() / "places.csv")));

  EXPECT_THAT(error("name,x,y\nb,1,2\n"), HasSubstr("places.csv:1:1: has no column \"z\""));
  EXPECT_THAT(error("name,x,y,z\n"), HasSubstr("places.csv: has no row"));
  EXPECT_THAT(error("name,x,y,z\nb,1,2\n"), HasSubstr("places.csv:2:1: has 3 entries"));
  EXPECT_THAT(error("name,x,y,z\nb,1,left,2\n"), HasSubstr("places.csv:2:5: got \"left\""));
  EXPECT_THAT(error("name,x,y,z\nb,1,,2\n"), HasSubstr("places.csv:2:1: the place of b is incom"));
  EXPECT_THAT(error("name,x,y,z\nb,1,0,2\nb,1,0,2\n"), HasSubstr(":3:1: b is listed twice"));
  EXPECT_THAT(error("name,x,y,z\nB1,1,0,2\n"), HasSubstr("has no place of any of the markers b"));
  std::string both = frames;
  both.insert(both.find("marker_places_file"), "marker_places: [], ");
  EXPECT_THAT(LoadError(Yaml(both, reference)), HasSubstr("give this or `marker_places`"));
}

TEST_F(RecordingTest, NamesMarkersThatNoFrameShows) {
  const std::string frames = "  {kind: markers, file: m.csv, columns: {time: t}}\n";
  const auto warnings = [&](const std::string& rows) {
    folder_.Write("m.csv", "t,a_x,a_y,a_z,b_x,b_y,b_z,c_x,c_y,c_z\n" + rows);
    WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
    return Load(Yaml(frames, "reference: {from: mesh, file: box.ply, length_unit: m}\n")).warnings;
  };
  EXPECT_THAT(warnings("0,1,2,3,,,,,,\n0.1,1,2,4,5,,7,,,\n"),
              ElementsAre(HasSubstr("m.csv: markers are not seen in any frame: b, c; ")));
  EXPECT_THAT(warnings("0,1,2,3,,,,4,5,6\n0.1,1,2,4,5,6,7,,,\n"), IsEmpty());
}

TEST_F(RecordingTest, WarnsOfMarkersAtZeroAndReadsTheirTimesInTheirUnit) {
  folder_.Write("m.csv",
                "t,a_x,a_y,a_z,b_x,b_y,b_z\n0,10,0,0,50,0,9\n20,0,0,0,50,0,9\n40,0,0,0,0,0,0\n");
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  const std::string reference = "reference: {from: mesh, file: box.ply, length_unit: m}\n";
  const std::string frames = "  {kind: markers, file: m.csv, columns: {time: t}, time_unit: ms";
  const Recording recording = Load(Yaml(frames + "}\n", reference));
  EXPECT_THAT(recording.times, ElementsAre(0, 0.02, 0.04));
  EXPECT_THAT(recording.warnings,
              ElementsAre(HasSubstr("m.csv: markers are at exactly (0, 0, 0), which counts as a "
                                    "measured position: a in 2, b in 1 of 3 frames")));
  EXPECT_THAT(LoadError(Yaml(frames + ", markers: [a, b, a]}\n", reference)),
              HasSubstr("frames.markers: lists a twice"));
  EXPECT_THAT(
      LoadError(Yaml("  {kind: markers, file: m.csv, rate: 1 Hz, time_unit: ms}\n", reference)),
      HasSubstr("frames.time_unit: belongs to a column"));
}

TEST_F(RecordingTest, WarnsWhenAMarkerFileContradictsTheUnit) {
  folder_.Write("m.trc",
                "PathFileType\t4\t(X/Y/Z)\tm.trc\nDataRate\tNumFrames\tNumMarkers\tUnits\n"
                "100\t1\t1\tm\nFrame#\tTime\tA\n\t\tX1\tY1\tZ1\n1\t0\t1\t2\t3\n");
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  const Recording recording =
      Load(Yaml("  {kind: markers, file: m.trc}\n", "reference: {from: mesh, file: box.ply}\n"));
  EXPECT_THAT(recording.warnings,
              ElementsAre(HasSubstr("says that its lengths are in m; recording.yaml says mm")));
}

TEST_F(RecordingTest, WarnsWhenTheColumnsOfMarkersContradictTheUnit) {
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  const auto yaml_for = [&](const std::string& x, const std::string& y) {
    folder_.Write("m.csv", "a_x" + x + ",a_y" + y + ",a_z" + x + "\n1,2,3\n");
    return Yaml("  {kind: markers, file: m.csv, columns: {x: \"*_x" + x + "\", y: \"*_y" + y +
                    "\", z: \"*_z" + x + "\"}}\n",
                "reference: {from: mesh, file: box.ply}\n");
  };
  EXPECT_THAT(Load(yaml_for(" [cm]", " [cm]")).warnings,
              ElementsAre(HasSubstr("says that its lengths are in cm; recording.yaml says mm")));
  EXPECT_THAT(Load(yaml_for(" [mm]", " [mm]")).warnings, IsEmpty());
  EXPECT_THAT(Load(yaml_for(" (left)", " (left)")).warnings, IsEmpty());
  EXPECT_THAT(LoadError(yaml_for(" [mm]", " [cm]")),
              HasSubstr("m.csv:1:1: gives coordinates in cm beside others in mm"));
}

TEST_F(RecordingTest, WrittenMarkerFramesAreReadBack) {
  Markers markers;
  markers.names = {"a", "b"};
  markers.places = (Eigen::Matrix3Xd(3, 2) << 0, 0.1, 0, 0, 0, 0.02).finished();
  for (const double shift : {0.0, 0.001}) {
    markers.positions.emplace_back(markers.places.array() + shift);
  }
  const std::string frames = WriteMarkerFrames(folder_.Path(), {0.25, 0.5}, markers);
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  const Recording recording = Load(Yaml(frames, "reference: {from: mesh, file: box.ply}\n", "m"));
  EXPECT_THAT(recording.times, ElementsAre(0.25, 0.5));
  EXPECT_EQ(recording.markers.names, markers.names);
  // The files have nine and six decimals.
  EXPECT_LT((recording.markers.positions[1] - markers.positions[1]).norm(), 1e-9);
  EXPECT_LT((recording.markers.places - markers.places).norm(), 1e-6);
  EXPECT_FALSE(IsScan(recording));
  EXPECT_THAT(DescribeRecording(recording), HasSubstr("markers      a, b"));
}

TEST_F(RecordingTest, EveryNameOfAMarkerIsReadBackAsItIs) {
  const std::vector<std::string> names = {"a,b",         "a;b",       "said \"so\"", "\"\"",
                                          "back\\slash", "two words", "größer",      "'quoted'",
                                          "#1",          "a: {b}"};
  std::vector<std::string> formulas = names;
  for (const char* name : {"=1+1", "+1", "-3", "@SUM(A1)", "\t=1", " blank"})
    formulas.emplace_back(name);
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  for (const std::vector<std::string>& all : {names, formulas}) {
    const auto count = static_cast<Eigen::Index>(all.size());
    const Markers markers{
        all, Eigen::Matrix3Xd::Constant(3, count, 0.01),
        std::vector<Eigen::Matrix3Xd>(2, Eigen::Vector3d(0.1, 0.2, 0.3).replicate(1, count))};
    const std::string frames = WriteMarkerFrames(folder_.Path(), {0.25, 0.5}, markers);
    const Recording recording = Load(Yaml(frames, "reference: {from: mesh, file: box.ply}\n", "m"));
    EXPECT_EQ(recording.markers.names, all);
    EXPECT_TRUE(recording.markers.places.isApprox(markers.places));
    EXPECT_TRUE(recording.markers.positions[1].isApprox(markers.positions[1]));
  }
  // No column begins like a formula, which a spreadsheet would evaluate.
  const std::string csv = FileContent(folder_ / "markers.csv");
  EXPECT_THAT(csv, HasSubstr(",'=1+1_x,'=1+1_y,'=1+1_z,"));
  EXPECT_THAT(csv, HasSubstr(",\"'a,b_x\","));
  EXPECT_THAT(csv, Not(ContainsRegex(",\"?[=+@]")));
  const Markers broken{{"a\nb"}, Eigen::Matrix3Xd::Zero(3, 1), {Eigen::Matrix3Xd::Zero(3, 1)}};
  EXPECT_THAT(ErrorOf([&] { WriteMarkerFrames(folder_.Path(), {0}, broken); }),
              HasSubstr("marker \"a\\u000ab\" has a line break"));
}

TEST_F(RecordingTest, ARateReplacesTheTimesOfAMarkerFile) {
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  folder_.Write("m.csv", "t,a_x,a_y,a_z\n0.00,0,0,0\n0.00,1,0,0\n0.01,2,0,0\n");
  const std::string reference = "reference: {from: mesh, file: box.ply, length_unit: m}\n";
  const std::string frames = "  {kind: markers, file: m.csv, columns: {time: t}";
  EXPECT_THAT(LoadError(Yaml(frames + "}\n", reference)),
              HasSubstr("`rate`, `times` or `times_file` in recording.yaml replace its times"));
  EXPECT_THAT(Load(Yaml(frames + ", rate: 200 Hz}\n", reference)).times,
              ElementsAre(0, 0.005, 0.01));
  EXPECT_THAT(Load(Yaml(frames + ", times: [1 s, 2 s, 3 s], from: 2 s}\n", reference)).times,
              ElementsAre(2, 3));
}

}  // namespace
}  // namespace lacuna
