#include "scan/recording.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "geometry/mesh_io.h"
#include "scan/recording_fixture.h"
#include "support/shapes.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST_F(RecordingTest, ReadsWhatIsKnownOfTheObjectInSi) {
  WriteClouds(3);
  folder_.Write("load.csv", "t_ms,fx,fy,fz\n0,0,0,-100\n100,0,0,-300\n");
  folder_.Write("grip.csv", "x,y,z\n100,0,0\n100,0,5\n100,0,10\n");
  const Recording recording = Load(
      Yaml("  kind: points\n  files: f/*.csv\n  rate: 20 Hz\n",
           "density: 1.07 g/cm^3\ngravity: [0, 0, -9.81 m/s^2]\n"
           "fixed: [{name: clamp, half_space: {point: [1 mm, 0, 0], normal: [-1, 0, 0]}}]\n"
           "gripped: [{name: hand, sphere: {center: [100 mm, 0, 0], radius: 5 mm},\n"
           "           path: {file: grip.csv, x: x, y: y, z: z}},\n"
           "          {name: rest, nodes: [1, 2]}]\n"
           "forces: [{name: pull, file: load.csv, time: t_ms, time_unit: ms, x: fx, y: fy, z: fz,\n"
           "          unit: mN, region: {nodes: [7]}}, {constant: [0, 0, -0.51 N]}]\n"
           "reference: {from: first_frame, sheet: {thickness: 2 mm, face: front}}\n"));
  EXPECT_DOUBLE_EQ(*recording.object.density, 1070);
  EXPECT_EQ(*recording.object.gravity, Eigen::Vector3d(0, 0, -9.81));
  EXPECT_THAT(recording.times, ElementsAre(0, 0.05, 0.1));
  ASSERT_EQ(recording.object.grips.size(), 2u);
  // The path follows the frames' times; its unit is the recording's.
  EXPECT_LT(
      (MotionAt(recording.object.grips[0], 0.075).translation() - Eigen::Vector3d(0, 0, 0.0075))
          .norm(),
      1e-15);
  EXPECT_EQ(recording.object.grips[1].motion, GripMotion::kFollowsScan);
  ASSERT_EQ(recording.object.forces.size(), 2u);
  EXPECT_NEAR(ForceAt(recording.object.forces[0], 0.025).z(), -0.15, 1e-15);
  EXPECT_NEAR(ForceAt(recording.object.forces[0], 9).z(), -0.3, 1e-15);
  EXPECT_NEAR(ForceAt(recording.object.forces[0], -9).z(), -0.1, 1e-15);
  EXPECT_EQ(ForceAt(recording.object.forces[1], 0.1), Eigen::Vector3d(0, 0, -0.51));
  EXPECT_FALSE(recording.object.forces[1].region.has_value());
  EXPECT_DOUBLE_EQ(recording.reference.sheet_thickness, 2e-3);
  EXPECT_THAT(recording.warnings, IsEmpty());
  const Frame frame = LoadFrame(recording, 2);
  EXPECT_EQ(frame.cloud.Size(), 12);
  EXPECT_DOUBLE_EQ(frame.cloud.points(0, 11), 0.102);
  EXPECT_EQ(recording.files.size(), 6u);
  const std::string text = DescribeRecording(recording);
  for (const char* part :
       {"3 point clouds, 0 s to 0.1 s",
        "12 points, 100 mm × 50 mm × 20 mm, from (0, 0, 0) to (0.1, 0.05, 0.02) m", "1070 kg/m³",
        "clamp: half-space", "hand: sphere", "given path", "pull: 2 values, at most 0.3 N",
        "an open sheet 2 mm thick"}) {
    EXPECT_THAT(text, HasSubstr(part));
  }
}

TEST_F(RecordingTest, MayLieApartFromItsData) {
  WriteClouds(2);
  setenv("LACUNA_TEST_FOLDER", folder_.Path().c_str(), 1);
  const auto yaml = folder_.Write("experiments/bar.yaml",
                                  Yaml("  kind: points\n  files: p*.csv\n  times: [0 s, 10 ms]\n",
                                       "data_folder: ${LACUNA_TEST_FOLDER}/f\n"));
  EXPECT_EQ(LoadRecording(yaml).FrameCount(), 2);
  unsetenv("LACUNA_TEST_FOLDER");
  EXPECT_THAT(ErrorOf([&] { LoadRecording(yaml); }),
              HasSubstr("data_folder: the environment variable LACUNA_TEST_FOLDER is not set"));
}

TEST_F(RecordingTest, ChoosesFramesByTimeAndStride) {
  WriteClouds(10);
  folder_.Write("f.csv", "0,0,0\n1,0,0\n2,0,0\n3,0,0\n4,0,0\n5,0,0\n6,0,0\n7,0,0\n8,0,0\n9,0,0\n");
  const Recording recording =
      Load(Yaml("  {kind: points, pattern: f/p%d.csv, count: 10, rate: 10 Hz, from: 0.2 s, to: 0.7 "
                "s, every: 2}\n",
                "forces: [{file: f.csv}]\n"));
  EXPECT_THAT(recording.times, ElementsAre(0.2, 0.4, 0.6));
  EXPECT_DOUBLE_EQ(LoadFrame(recording, 1).cloud.points(0, 0), 0.004);
  // One row per frame of the files, not per frame chosen.
  EXPECT_DOUBLE_EQ(ForceAt(recording.object.forces[0], recording.times[2]).x(), 6);
}

TEST_F(RecordingTest, NamesFileAndFrameOfAnUnusableFrame) {
  WriteClouds(3);
  const std::string yaml = Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n");
  const auto message = [&](const std::string& content) {
    folder_.Write("f/p1.csv", content);
    const Recording recording = Load(yaml);
    return ErrorOf([&] { LoadFrame(recording, 1); });
  };
  const std::string file = (folder_.Path() / "f/p1.csv").string();
  EXPECT_EQ(message(""), "frame 1 of \"bar\": " + file + ": is empty");
  EXPECT_EQ(message("x,y,z\n1,2,3\n"),
            "frame 1 of \"bar\": " + file + ": holds 1 usable point; expected at least 4");
  EXPECT_EQ(message("x,y,z\nnan,1,2\n1,nan,2\n3,3,\n1,,1\n2,,2\n"),
            "frame 1 of \"bar\": " + file + ": none of its 5 points is finite");
  EXPECT_EQ(message("x,y,z\n1e300,1,2\n1,-1e30,2\n0,0,1\n"),  // in squares beyond all numbers
            "frame 1 of \"bar\": " + file + ": holds 1 usable point; expected at least 4");
  EXPECT_THAT(message("x,y,z\n1,2\n"), HasSubstr("p1.csv:2:1: has 2 entries"));
  const Recording recording = Load(yaml);
  std::filesystem::remove(file);
  EXPECT_EQ(ErrorOf([&] { LoadFrame(recording, 1); }),
            "frame 1 of \"bar\": " + file + ": cannot be read: no such file, or no permission");
  WriteClouds(4);
  std::filesystem::remove(folder_.Path() / "f/p2.csv");
  EXPECT_THAT(LoadError(yaml), HasSubstr("frames.files: the frame numbered 2 is missing"));
  folder_.Write("f/p2.csv", "");
  folder_.Write("f/p0.csv", "x,y,z\n1,2,3\n");
  folder_.Write("f/p1.csv", "x,y,z\n1,2,3\n");
  EXPECT_THAT(LoadError(yaml), HasSubstr("frame 0 of \"bar\""));
}

TEST_F(RecordingTest, RefusesContradictoryCounts) {
  WriteClouds(3);
  EXPECT_THAT(LoadError(Yaml("  {kind: points, files: f/*.csv, times: [0 s, 1 s]}\n")),
              HasSubstr("frames.times: 2 times for 3 frames"));
  EXPECT_THAT(LoadError(Yaml("  {kind: points, files: f/*.csv, times: [0 s, 1 s, 1 s]}\n")),
              HasSubstr("frames.times: frame 2: the time 1 s is not later than"));
  EXPECT_THAT(LoadError(Yaml("  {kind: points, files: f/*.csv}\n")),
              HasSubstr("no times are given"));
  EXPECT_THAT(
      LoadError(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz, times: [0 s, 1 s, 2 s]}\n")),
      HasSubstr("given more than once"));
  EXPECT_THAT(LoadError(Yaml("  {kind: points, pattern: f/p%d.csv, count: 4, rate: 1 Hz}\n")),
              HasSubstr("frame 3: there is no file"));
  folder_.Write("load.csv", "0,0,1\n0,0,2\n");
  EXPECT_THAT(LoadError(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz}\n",
                             "forces: [{file: load.csv}]\n")),
              HasSubstr("has 2 rows for 3 frames"));
  folder_.Write("f/p2.csv", "x,y,z\n" + Cloud(11));
  const Recording tracked =
      Load(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz, tracked: true}\n"));
  EXPECT_THAT(ErrorOf([&] { LoadFrame(tracked, 2); }),
              HasSubstr("p2.csv: holds 11 points where frame 0 holds 12"));
  folder_.Write("t.csv", "0,1,12\n");
  EXPECT_THAT(LoadError(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz, triangles: t.csv}\n")),
              HasSubstr("triangle 0 has the corner 12; the frame has 12 rows"));
}

TEST_F(RecordingTest, LocatesMistakesInTheYamlByLineAndColumn) {
  WriteClouds(2);
  const std::string frames = "  {kind: points, files: f/*.csv, rate: 1 Hz}\n";
  EXPECT_THAT(LoadError(Yaml(frames, "dencity: 1 kg/m^3\n")),
              HasSubstr("recording.yaml:4:1: dencity: unknown key; did you mean \"density\"?"));
  EXPECT_THAT(
      LoadError(Yaml("  {kind: points, files: f/*.csv, rate: 1 Hz, trakced: true}\n")),
      HasSubstr("recording.yaml:5:46: frames.trakced: unknown key; did you mean \"tracked\"?"));
  EXPECT_THAT(LoadError(Yaml(frames, "density: 3 kg\n")),
              HasSubstr("recording.yaml:4:10: density"));
  EXPECT_THAT(LoadError(Yaml(frames, "", "inch")), HasSubstr("length_unit: got \"inch\""));
  EXPECT_THAT(LoadError(Yaml("  {kind: cloud, files: f/*.csv}\n")), HasSubstr("frames.kind"));
  EXPECT_THAT(LoadError(Yaml(frames, "data_folder: nowhere\n")), HasSubstr("there is no folder"));
  EXPECT_THAT(LoadError(Yaml(frames, "reference: {from: mesh, file: no.ply}\n")),
              HasSubstr("reference.file: there is no file"));
  EXPECT_THAT(ErrorOf([&] { LoadRecording(folder_.Path() / "absent"); }), HasSubstr("absent"));
}

TEST_F(RecordingTest, WarnsOfASizeThatSuggestsAnotherUnit) {
  WriteClouds(1);  // 100 × 50 × 20 in the units of the file
  const std::string frames = "  {kind: points, files: f/*.csv}\n";
  EXPECT_THAT(Load(Yaml(frames, "", "mm")).warnings, IsEmpty());
  EXPECT_THAT(Load(Yaml(frames, "", "m")).warnings,
              ElementsAre(HasSubstr("frame 0 is 114 m across with length_unit: m; it would be 1.14 "
                                    "m with length_unit: cm or 0.114 m with length_unit: mm")));
  folder_.Write("f/p0.csv", "x,y,z\n0,0,0\n0.1,0,0\n0,0.05,0\n0,0,0.02\n");
  EXPECT_THAT(Load(Yaml(frames, "", "m")).warnings, IsEmpty());
  EXPECT_THAT(
      Load(Yaml(frames, "", "mm")).warnings,
      ElementsAre(HasSubstr("frame 0 is 0.000114 m across with length_unit: mm; it would be "
                            "0.114 m with length_unit: m")));
  // The reference alone may have the wrong unit, too.
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  const std::string reference = "reference: {from: mesh, file: box.ply";
  EXPECT_THAT(Load(Yaml(frames, reference + "}\n", "m")).warnings, IsEmpty());
  EXPECT_THAT(Load(Yaml(frames, reference + ", length_unit: mm}\n", "m")).warnings,
              ElementsAre(HasSubstr("the reference shape is 0.000114 m across, frame 0 0.114 m")));
}

TEST_F(RecordingTest, NamesTheFirstUsableTimeWhereLeadingFramesAreEmpty) {
  WriteClouds(5);
  for (const int i : {0, 1, 2})
    folder_.Write("f/p" + std::to_string(i) + ".csv", "x,y,z\n0,0,0\n0,0,0\n0,0,0\n0,0,0\n");
  EXPECT_THAT(
      LoadError(Yaml("  {kind: points, files: f/*.csv, rate: 20 Hz}\n")),
      HasSubstr("4 repeat exactly; the first usable frame is 3: `from: 0.15 s` begins there"));
  EXPECT_EQ(
      Load(Yaml("  {kind: points, files: f/*.csv, rate: 20 Hz, from: 0.15 s}\n")).FrameCount(), 2);
}

TEST_F(RecordingTest, DoubtsADensityLikeThatOfAir) {
  WriteClouds(1);
  const std::string frames = "  {kind: points, files: f/*.csv}\n";
  EXPECT_THAT(Load(Yaml(frames, "density: 1.07 kg/m^3\n")).warnings,
              ElementsAre(HasSubstr("a density of 1.07 kg/m³ is like that of air")));
  EXPECT_THAT(Load(Yaml(frames, "density: 20 kg/m^3\n")).warnings, IsEmpty()) << "a foam";
  EXPECT_THAT(Load(Yaml(frames, "density: 1e6 kg/m^3\n")).warnings,
              ElementsAre(HasSubstr("above that of all metals")));
}

TEST_F(RecordingTest, DoubtsLoadsInAnotherUnitOfTime) {
  WriteClouds(11);
  std::string load = "t,x,y,z\n";
  for (int i = 0; i <= 20; ++i) load += fmt::format("{},0,0,{}\n", 25 * i, i);
  folder_.Write("load.csv", load);
  const std::string frames = "  {kind: points, files: f/*.csv, rate: 20 Hz}\n";
  EXPECT_THAT(
      Load(Yaml(frames, "forces: [{name: pull, file: load.csv, time: t, x: x, y: y, z: z}]\n"))
          .warnings,
      ElementsAre(testing::AllOf(HasSubstr("the force pull ("),
                                 HasSubstr("divided by 1000 (milliseconds, not seconds?)"))));
  EXPECT_THAT(
      Load(Yaml(frames, "forces: [{file: load.csv, time: t, time_unit: ms, x: x, y: y, z: z}]\n"))
          .warnings,
      IsEmpty());
  EXPECT_THAT(
      Load(Yaml(frames, "gripped: [{nodes: [1], path: {file: load.csv, time: t}}]\n")).warnings,
      ElementsAre(HasSubstr("the path of grip 1 (")));
}

TEST_F(RecordingTest, WarnsOfARateThatContradictsTheTimesOfTheFile) {
  WriteTriMesh(folder_.Path() / "box.ply", BoxSurface({0.1, 0.05, 0.02}, {1, 1, 1}));
  std::string rows = "t,a_x,a_y,a_z,b_x,b_y,b_z\n";
  for (int k = 0; k < 41; ++k) rows += fmt::format("{},0,0,0,50,0,0\n", 0.1 * k);
  folder_.Write("m.csv", rows);
  const auto warnings = [&](const std::string& rate) {
    return Load(Yaml("  {kind: markers, file: m.csv, columns: {time: t}, rate: " + rate + "}\n",
                     "reference: {from: mesh, file: box.ply, length_unit: m}\n"))
        .warnings;
  };
  const auto warning = HasSubstr("those of the files 4 s (10 Hz on average)");
  EXPECT_THAT(warnings("12 Hz"), testing::Contains(warning));
  EXPECT_THAT(warnings("10.1 Hz"), testing::Not(testing::Contains(warning)));
}

TEST_F(RecordingTest, HasTheNameOfItsFolder) {
  folder_.Write("bar/p.csv", "x,y,z\n" + Cloud(12));
  folder_.Write("bar/recording.yaml",
                "schema_version: 1\nlength_unit: mm\nframes: {kind: points, files: [p.csv]}\n");
  EXPECT_EQ(LoadRecording(folder_.Path() / "bar").name, "bar");
  EXPECT_EQ(LoadRecording(folder_.Path() / "bar/.").name, "bar");
}

TEST_F(RecordingTest, DoubtsATableWhoseFirstRowWasTakenForNames) {
  folder_.Write("p.csv", "0.5,1.5,lost\n" + Cloud(12));
  EXPECT_THAT(
      Load(Yaml("  {kind: points, files: [p.csv], columns: {x: '1', y: '2', z: '3'}}\n")).warnings,
      ElementsAre(HasSubstr("the first line was taken for the names of the columns")));
}

}  // namespace
}  // namespace lacuna
