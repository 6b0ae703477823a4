// The recordings of a prediction study: their frames, grips, loads and holds, and what is refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "prediction/prediction_study.h"
#include "prediction/reading_a_prediction_study.h"
#include "prediction/recorded_motion.h"

namespace lacuna {
namespace {

using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(ReadingAPredictionStudy, RefusesTooFewFrames) {
  EXPECT_THAT(MessageAfter({{"    fit_until", "    from: 0.1 s\n    to: 0.115 s\n    fit_until"}}),
              ContainsRegex("study.yaml:[0-9]+:[0-9]+: recordings.0..recording: 2 frames lie "
                            "between 0.1 s and 0.115 s; at least 3 are needed"));
  EXPECT_THAT(MessageAfter({{"fit_until: 0.1501 s", "fit_until: 0.015 s"}}),
              HasSubstr("recordings[0].fit_until: leaves fewer than 3 frames to fit"));
}

TEST_F(ReadingAPredictionStudy, RefusesMarkersWithoutAShape) {
  EXPECT_THAT(MessageAfterInRecording({{"reference: {from: mesh, file: box.off}\n", ""}}),
              HasSubstr("reference: the frames do not show the surface"));
  EXPECT_THAT(
      MessageAfterInRecording({{"    - {name: m3,", "    #- {name: m3,"}}),
      ContainsRegex("recordings\\[0\\].recording: the place of m3 on the undeformed object is "
                    "not known: .*`marker_places` .or `marker_places_file`. for it, or `markers: "
                    "\\[m0, m1, m2, m4"));
}

TEST_F(ReadingAPredictionStudy, NamesTheEntryOfAnAbsentRecording) {
  EXPECT_THAT(MessageAfter({{"recording.yaml", "recordin.yaml"}}),
              ContainsRegex("study.yaml:[0-9]+:[0-9]+: recordings\\[0\\].recording: there is no "
                            "file or folder .*recordin.yaml"));
  std::filesystem::create_directories(folder_ / "empty");
  EXPECT_THAT(MessageAfter({{"recording.yaml", "empty"}}),
              HasSubstr("empty contains no recording.yaml"));
}

TEST_F(ReadingAPredictionStudy, TakesScansButNoHeldOneForTheShape) {
  Replacements scans{{(folder_ / "recording.yaml").string(),
                      std::string(LACUNA_SOURCE_DIR) + "/experiments/recordings/bend"}};
  EXPECT_THAT(MessageAfter(scans), HasSubstr("recordings[0].hold: the recording's reference shape "
                                             "is its first frame, in which the object is held"));
  scans.insert(kNoHold.begin(), kNoHold.end());
  const PredictionStudy study = ReadBarStudy(folder_.Path(), scans);
  ASSERT_NE(study.recordings[0].scans, nullptr);
  EXPECT_EQ(study.recordings[0].frames.size(), 16u);
  EXPECT_EQ(study.scan.patches, 150);
}

TEST_F(ReadingAPredictionStudy, RefusesMarkersWhoseGripFollowsAScan) {
  EXPECT_THAT(
      MessageAfterInRecording(
          {{"reference",
            "gripped: [{name: tool, half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, "
            "0]}}]\nreference"}}),
      HasSubstr("tool is to follow the scan, but there are only markers"));
}

TEST_F(ReadingAPredictionStudy, RefusesAnObjectThatNothingHolds) {
  const std::string clamp =
      "fixed: [{name: clamp, half_space: {point: [0.002 m, 0 m, 0 m], normal: [-1, 0, 0]}}]\n";
  EXPECT_THAT(
      MessageAfterInRecording({{clamp, ""}}),
      AllOf(HasSubstr("recordings[0].recording: nothing holds the object after its release"),
            HasSubstr("a plane on which it lies does not suffice")));
  const std::string damping = "  - {type: mass_damping, alpha: 1 1/s}\n";
  EXPECT_EQ(
      MessageAfterInRecording(
          {{clamp, ""}}, {{damping, damping + "  - {type: elastic_support, modulus: 1 MPa/m}\n"}}),
      "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, RefusesAReleaseAfterTheEnd) {
  EXPECT_THAT(MessageAfter({{"release: 0.0437 s", "release: 0.3 s"}}),
              HasSubstr("recordings[0].hold.release: lies after the last frame that is used, at "
                        "0.25 s"));
  const auto message = [&](const std::string& to) {
    return MessageAfter({{"release: 0.0437 s", "release: 0.1237 s"},
                         {"    fit_until", "    to: " + to + "\n    fit_until"}});
  };
  EXPECT_THAT(message("0.12 s"),
              HasSubstr("hold.release: lies after the last frame that is used, at 0.12 s: the "
                        "object is never released"));
  EXPECT_EQ(message("0.13 s"), "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, RefusesAReleaseThatNoFrameComesBefore) {
  EXPECT_THAT(MessageAfter({{"release: 0.0437 s", "release: -1 s"}}),
              HasSubstr("hold.release: lies before the first frame that is used, at 0 s"));
  const auto message = [&](const std::string& from) {
    return MessageAfter({{"    fit_until", "    from: " + from + "\n    fit_until"}});
  };
  EXPECT_THAT(message("0.05 s"),
              HasSubstr("hold.release: lies before the first frame that is used, at 0.05 s: no "
                        "frame shows the object while it is held"));
  EXPECT_EQ(message("0.04 s"), "nothing was refused");
  EXPECT_THAT(MessageAfter({{"    fit_until", "    fit_untl"}}),
              HasSubstr("did you mean \"fit_until\""));
}

TEST_F(ReadingAPredictionStudy, RefusesALoadThatDoesNotCoverTheFrames) {
  const std::string load =
      "forces: [{name: pull, file: load.csv, time: t, x: x, y: y, z: z, region: {half_space: "
      "{point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}}]\nreference";
  EXPECT_THAT(MessageAfterInRecording({{"reference", load}}),
              ContainsRegex("load.csv covers 0.05 s to 0.2 s, the frames 0 s to 0.25 s"));
  EXPECT_EQ(MessageAfterInRecording(
                {{"reference", load}},
                {{"release: 0.0437 s", "release: 0.0537 s"},
                 {"    fit_until", "    from: 0.05 s\n    to: 0.2 s\n    fit_until"}}),
            "nothing was refused");
  EXPECT_THAT(MessageAfterInRecording({{"reference",
                                        "forces: [{name: pull, constant: [0 N, 0 N, 1 N]}]\n"
                                        "reference"}}),
              HasSubstr("does not say where pull acts"));
}

TEST_F(ReadingAPredictionStudy, RefusesAGripWhosePathDoesNotCoverTheFrames) {
  const std::string grip =
      "gripped: [{name: tool, half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}, path: "
      "{file: load.csv, time: t, x: x, y: y, z: z}}]\nreference";
  EXPECT_THAT(MessageAfterInRecording({{"reference", grip}}),
              ContainsRegex("load.csv covers 0.05 s to 0.2 s, the frames 0 s to 0.25 s: it begins "
                            "50 ms after the first of them, and ends 50 ms before the last of "
                            "them; extend this file, which gripped.0..path names in "
                            ".*recording.yaml, or use fewer frames"));
  Replacements from_first_row_to_last = kNoHold;
  from_first_row_to_last["    fit_until"] = "    from: 0.05 s\n    to: 0.2 s\n    fit_until";
  EXPECT_EQ(MessageAfterInRecording({{"reference", grip}}, from_first_row_to_last),
            "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, RefusesPlacementsThatSayNothing) {
  const auto message = [&](const std::string& more) {
    return MessageAfterInRecording({{"normal: [-1, 0, 0]}", "normal: [-1, 0, 0]}, " + more}});
  };
  EXPECT_EQ(message("placement: {shift_deviation: 1 mm}"), "nothing was refused");
  EXPECT_THAT(message("placement: {shift_deviation: 0 mm}"),
              ContainsRegex("recording.yaml.*placement: needs a shift_deviation or a "
                            "turn_deviation above 0"));
  EXPECT_THAT(message("placement: {turn_deviation: 1 deg}, directions: [x]"),
              HasSubstr("placement: cannot be combined with `directions`"));
}

TEST_F(ReadingAPredictionStudy, RefusesTwoRecordingsOfOneName) {
  std::string text = BarExperiment(folder_.Path());
  const std::string entry = text.substr(text.find("  - recording: "));
  const std::string message = MessageOf(text + entry);
  EXPECT_THAT(message, HasSubstr("recordings[1].name: \""));
  EXPECT_THAT(message, HasSubstr("is already the name of another recording"));
}

TEST_F(ReadingAPredictionStudy, RefusesMarkersThatRestWhereTheySitAnyway) {
  std::mt19937 random(3);
  std::normal_distribution<double> noise(0, 1e-4);  // m
  auto markers = Moving(0);
  for (auto& frame : markers)
    for (double& coordinate : frame.reshaped()) coordinate += noise(random);
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_THAT(MessageAfter({}),
              HasSubstr("recordings: nothing moves in the frames that are fitted"));

  // At rest elsewhere they tell at least what statics can, but no more.
  for (auto& frame : markers) frame.array() += 0.01;
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_EQ(MessageAfter({}), "nothing was refused");
  EXPECT_THAT(RestWarning(ReadBarStudy(folder_.Path())), HasSubstr("anything else that needs"));
  WriteBarRecording(folder_.Path(), Moving(0.001));
  EXPECT_EQ(RestWarning(ReadBarStudy(folder_.Path())), "");
}

TEST_F(ReadingAPredictionStudy, TakesTheNoiseOfRestForNoMotion) {
  // Moved in the middle, and at rest in the end where it was in the beginning.
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1e-4);
  for (const double far : {0.0, 0.01}) {
    std::vector<Eigen::Matrix3Xd> markers;
    for (int frame = 0; frame < kFrames; ++frame) {
      const double away = frame > 8 && frame < 18 ? far : 0;
      markers.emplace_back(BarMarkerPlaces().array() + away + 2e-3);
      for (double& value : markers.back().reshaped()) value += normal(random);
    }
    WriteBarRecording(folder_.Path(), markers);
    EXPECT_EQ(MessageAfter(kNoHold), "nothing was refused");
  }
}

TEST_F(ReadingAPredictionStudy, RefusesAStartInMotion) {
  WriteBarRecording(folder_.Path(), Moving(0.001, 0));
  EXPECT_EQ(MessageAfter({}), "nothing was refused");  // held until 0.04 s
  auto markers = Moving(0, 0);
  for (size_t frame = 1; frame < markers.size(); ++frame) markers[frame].array() += 0.001;
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_THAT(MessageAfter(kNoHold), HasSubstr("the object already moves between its first two"));
  // The first marker is not seen at first: the others tell.
  markers[0].col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_THAT(MessageAfter(kNoHold), HasSubstr("the object already moves between its first two"));
  WriteBarRecording(folder_.Path(), Moving(0.001));
  EXPECT_EQ(MessageAfter(kNoHold), "nothing was refused");
}

TEST(PredictedRecording, FitsItsUsedFramesUntilATime) {
  PredictedRecording item;
  item.recording.times = {0, 1, 2, 3, 4};
  item.frames = {0, 2, 4};
  item.fit_until = 2;
  EXPECT_THAT(item.FittedFrames(), ElementsAre(0, 2));
  EXPECT_FALSE(item.IsFitted(4));
  item.fitted = false;
  EXPECT_THAT(item.FittedFrames(), testing::IsEmpty());
  EXPECT_FALSE(item.IsFitted(0));
}

}  // namespace
}  // namespace lacuna
