#include "scan/recording_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "scan/recording_fixture.h"

namespace lacuna {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class RecordingCheckTest : public RecordingTest {
 protected:
  std::vector<std::string> Findings(int64_t most_points = 1'000'000'000) const {
    return ExamineFrames(Load(Yaml("  {kind: points, files: f/*.csv, rate: 10 Hz}\n")),
                         most_points);
  }
};

TEST_F(RecordingCheckTest, TellsFramesThatRepeatTheOneBefore) {
  WriteClouds(6);
  EXPECT_THAT(Findings(), IsEmpty());
  folder_.Write("f/p3.csv", "x,y,z\n" + Cloud(12, 2));
  EXPECT_THAT(Findings(), ElementsAre(HasSubstr("1 of 6 frames repeats the one before exactly "
                                                "(frame 3)")));
  folder_.Write("f/p4.csv", "x,y,z\n" + Cloud(12, 2));
  EXPECT_THAT(Findings(), ElementsAre(HasSubstr("2 of 6 frames repeat the one before exactly "
                                                "(frames 3, 4)")));
}

TEST_F(RecordingCheckTest, TellsFramesOfAnotherSize) {
  WriteClouds(4);
  std::istringstream rows(Cloud(12));
  std::string small = "x,y,z\n";
  for (double x, y, z; rows >> x && rows.ignore() >> y && rows.ignore() >> z;)
    small += std::to_string(x / 1000) + "," + std::to_string(y / 1000) + "," +
             std::to_string(z / 1000) + "\n";
  folder_.Write("f/p2.csv", small);
  EXPECT_THAT(Findings(),
              ElementsAre(HasSubstr("frame 2: 0.000114 m across where frame 0 is 0.114 m")));
}

TEST_F(RecordingCheckTest, TellsSmallComponentsWithSizeAndPlace) {
  WriteClouds(3, 200);
  std::string debris = "x,y,z\n" + Cloud(200);
  for (int i = 0; i < 6; ++i) debris += std::to_string(300 + i) + ",0,0\n";
  folder_.Write("f/p2.csv", debris);
  EXPECT_THAT(Findings(),
              ElementsAre(HasSubstr("frame 2: beside the largest component there is 1 separate "
                                    "component: 6 points, 5 mm across, around (0.302, 0, 0) m")));
}

TEST_F(RecordingCheckTest, TellsPointsThatRepeatInLaterFrames) {
  WriteClouds(3);
  folder_.Write("f/p2.csv", "x,y,z\n" + Cloud(12, 2) + "0,0,0\n0,0,0\n");
  EXPECT_THAT(Findings(), ElementsAre(HasSubstr("left out of 1 later frames (2)")));
}

TEST_F(RecordingCheckTest, NamesRegionsBesideTheReferenceShape) {
  WriteClouds(2);
  folder_.Write("t.off",
                "OFF\n4 4 0\n0 0 0\n100 0 0\n0 50 0\n0 0 20\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n");
  const auto findings = [&](const std::string& region) {
    return ExamineFrames(Load(
        Yaml("  {kind: points, files: f/*.csv, rate: 10 Hz}\n",
             "reference: {from: mesh, file: t.off}\nfixed: [{name: clamp, " + region + "}]\n")));
  };
  for (const char* on : {"half_space: {point: [1 mm, 0 m, 0 m], normal: [-1, 0, 0]}",
                         "box: {min: [-9 mm, -9 mm, -9 mm], max: [1 mm, 99 mm, 99 mm]}",
                         "sphere: {center: [-1 mm, 0 m, 0 m], radius: 2 mm}"})
    EXPECT_THAT(findings(on), IsEmpty()) << on;
  for (const char* beside : {"half_space: {point: [1 m, 0 m, 0 m], normal: [1, 0, 0]}",
                             "box: {min: [-9 mm, -9 mm, -9 mm], max: [-1 mm, 99 mm, 99 mm]}",
                             "sphere: {center: [-3 mm, 0 m, 0 m], radius: 2 mm}"})
    EXPECT_THAT(findings(beside), ElementsAre(testing::AllOf(
                                      HasSubstr("region \"clamp\""),
                                      HasSubstr("holds nothing of the reference shape, which "
                                                "extends from (0, 0, 0) to (0.1, 0.05, 0.02) m"))))
        << beside;
}

TEST_F(RecordingCheckTest, SaysWhereItStopped) {
  WriteClouds(5);
  EXPECT_THAT(Findings(24), ElementsAre("only the first 2 of 5 frames were examined"));
}

TEST_F(RecordingCheckTest, GivesEachFrameToAFurtherExamination) {
  WriteClouds(4);
  std::vector<int> given;
  const auto also = [&](const Frame& frame) { given.push_back(frame.index); };
  ExamineFrames(Load(Yaml("  {kind: points, files: f/*.csv, rate: 10 Hz}\n")), 1'000'000, also);
  EXPECT_THAT(given, ElementsAre(0, 1, 2, 3));
}

}  // namespace
}  // namespace lacuna
