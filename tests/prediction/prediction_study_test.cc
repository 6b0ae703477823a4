// What a prediction study takes from its file, what it refuses, and what it warns of.
#include "prediction/prediction_study.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "effects/gravity.h"
#include "prediction/reading_a_prediction_study.h"
#include "prediction/recorded_motion.h"
#include "record/effect_card.h"

namespace lacuna {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

TEST_F(ReadingAPredictionStudy, TakesWhatIsThere) {
  const PredictionStudy study = ReadBarStudy(folder_.Path());
  EXPECT_TRUE(IsPredictionStudy(Config::Parse(BarExperiment(folder_.Path()), "e.yaml")));
  ASSERT_EQ(study.recordings.size(), 1u);
  const PredictedRecording& item = study.recordings[0];
  EXPECT_EQ(item.frames.size(), static_cast<size_t>(kFrames));
  ASSERT_TRUE(item.hold.has_value());
  EXPECT_EQ(item.hold->release, kRelease);
  EXPECT_EQ(item.fit_until, kFitUntil);
  EXPECT_EQ(study.density, 1000);
  EXPECT_EQ(study.scheme, TimeScheme::kTwoStep);
  ASSERT_EQ(study.fitted.size(), 2u);
  EXPECT_EQ(study.fitted[0].prior.name, "young_modulus");
  EXPECT_EQ(study.fitted[1].prior.name, "mass_damping.alpha");
  const PredictionStudy some = ReadBarStudy(
      folder_.Path(),
      {{"    fit_until", "    from: 0.04 s\n    to: 0.2 s\n    every: 5\n    fit_until"}});
  EXPECT_THAT(some.recordings[0].frames, ElementsAre(4, 9, 14, 19));
}

TEST_F(ReadingAPredictionStudy, RefusesNothingToFit) {
  EXPECT_THAT(MessageAfter({{"    fit_until", "    fitted: false\n    fit_until"}}),
              HasSubstr("recordings: none of them is fitted"));
  std::string none = BarExperiment(folder_.Path());
  none.replace(none.find("recordings:"), std::string::npos, "recordings: []\n");
  EXPECT_THAT(MessageOf(none), HasSubstr("recordings: is empty"));
}

// The normal of the clamp has the wrong sign: the bar is clamped but for its end.
TEST_F(ReadingAPredictionStudy, RefusesAClampThatHoldsAllMarkers) {
  EXPECT_THAT(MessageAfterInRecording({{"normal: [-1, 0, 0]", "normal: [1, 0, 0]"}}),
              testing::AllOf(HasSubstr("recordings[0].recording: region \"clamp\" of"),
                             HasSubstr("recording.yaml holds all 8 markers")));
  EXPECT_EQ(
      MessageAfterInRecording({{"normal: [-1, 0, 0]}", "normal: [1, 0, 0]}, directions: [x]"}}),
      "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, TakesEquilibria) {
  const std::string statics = "motion: {scheme: quasi_static}";
  EXPECT_THAT(MessageAfter({{"motion: {time_step: 1.5 ms}", statics}}),
              HasSubstr("recordings[0].hold: a released object vibrates"));
  Replacements one{{"motion: {time_step: 1.5 ms}", statics},
                   {"    fit_until", "    from: 0.1 s\n    to: 0.115 s\n    fit_until"}};
  one.insert(kNoHold.begin(), kNoHold.end());
  EXPECT_EQ(MessageAfter(one), "nothing was refused");
  const PredictionStudy study = ReadBarStudy(folder_.Path(), one);
  EXPECT_EQ(study.recordings[0].frames.size(), 2u);
  EXPECT_NEAR(study.time_step, 0.01, 1e-12);  // a step a frame
  // Frames far from each other: no start in motion.
  WriteBarRecording(folder_.Path(), Moving(0.001, 0));
  EXPECT_EQ(MessageAfter(one), "nothing was refused");
}

TEST_F(ReadingAPredictionStudy, RefusesStepsThatFollowNoMotion) {
  EXPECT_THAT(MessageAfter({{"time_step: 1.5 ms", "time_step: 0.1 s"}}),
              HasSubstr("motion.time_step: makes 2.5 steps"));
  EXPECT_THAT(MessageAfter({{"time_step: 1.5 ms", "time_step: 1e-12 s"}}),
              HasSubstr("motion.time_step: makes 2.5e+11 steps"));
}

TEST_F(ReadingAPredictionStudy, TellsOfASlowRecording) {
  PredictionStudy study = ReadBarStudy(folder_.Path(), {{"motion: {time_step: 1.5 ms}\n", ""}});
  EXPECT_THAT(StudyWarnings(study), ElementsAre());
  for (double& time : study.recordings[0].recording.times) time *= 1000;  // a frame in 10 s
  study.recordings[0].fit_until *= 1000;
  EXPECT_THAT(StudyWarnings(study),
              ElementsAre(HasSubstr("50000 steps of 5 ms for 26 frames: if the object is in "
                                    "equilibrium")));
  study.scheme = TimeScheme::kQuasiStatic;
  EXPECT_THAT(StudyWarnings(study), ElementsAre());
}

TEST_F(ReadingAPredictionStudy, TellsOfGravityThatTheModelLacks) {
  PredictionStudy study = ReadBarStudy(folder_.Path());
  ASSERT_THAT(StudyWarnings(study), ElementsAre());
  study.recordings[0].recording.object.gravity = Eigen::Vector3d(0, 0, -9.81);
  EXPECT_THAT(StudyWarnings(study), ElementsAre());
  std::erase_if(study.effects, [](const auto& effect) { return effect->Card().type == "gravity"; });
  EXPECT_THAT(StudyWarnings(study),
              ElementsAre(HasSubstr("was recorded under gravity, but the model "
                                    "has none")));
  study.recordings[0].effects.push_back(MakeGravity(Eigen::Vector3d(0, 0, -9.81)));
  EXPECT_THAT(StudyWarnings(study), ElementsAre());
  study.recordings[0].effects.pop_back();
  study.recordings[0].recording.object.gravity = Eigen::Vector3d::Zero();
  EXPECT_THAT(StudyWarnings(study), ElementsAre()) << "in free fall";
}

TEST_F(ReadingAPredictionStudy, WarnsWhereNoFrameIsHeldOut) {
  EXPECT_THAT(StudyWarnings(ReadBarStudy(folder_.Path())),
              testing::Not(testing::Contains(HasSubstr("fit_until"))));
  const std::string until = fmt::format("fit_until: {} s", kFitUntil);
  const PredictionStudy late = ReadBarStudy(folder_.Path(), {{until, "fit_until: 9 s"}});
  EXPECT_THAT(StudyWarnings(late),
              testing::Contains(HasSubstr("bar: `fit_until: 9 s` does not lie before the last "
                                          "frame that is used, at 0.25 s")));
  EXPECT_EQ(late.recordings[0].FittedFrames(), late.recordings[0].frames);
}

// The first frame that is used shows the undeformed shape, but the path has rows before it.
TEST_F(ReadingAPredictionStudy, WarnsOfAPathThatMovesBeforeTheUndeformedFrame) {
  PredictionStudy study = ReadBarStudy(folder_.Path(), kNoHold);
  PredictedRecording& item = study.recordings[0];
  item.recording.reference.source = ReferenceSource::kFirstFrame;
  RecordedGrip grip;
  grip.region.name = "tool";
  grip.motion = GripMotion::kGiven;
  grip.file = "path.csv";
  grip.times = Eigen::Vector3d(-0.1, 0, 0.3);
  grip.displacements = Eigen::Matrix3Xd::Zero(3, 3);
  const auto warned = testing::Contains(HasSubstr("counts from the first row of its path"));
  for (const double before : {0.0, 5e-5}) {
    grip.displacements.row(2) << 0, before, 0.01;
    item.recording.object.grips = {grip};
    EXPECT_THAT(StudyWarnings(study), testing::Not(warned)) << before;
  }
  grip.displacements(2, 1) = 2e-4;
  item.recording.object.grips = {grip};
  EXPECT_THAT(
      StudyWarnings(study),
      testing::Contains(HasSubstr(
          "bar: the first frame that is used, at 0 s, is to show the object undeformed, but "
          "\"tool\" has moved by 0.2 mm and 0° by then")));
  item.recording.reference.source = ReferenceSource::kMesh;
  EXPECT_THAT(StudyWarnings(study), testing::Not(warned));
}

TEST_F(ReadingAPredictionStudy, WarnsOfANegativePoissonRatioOnce) {
  const auto warnings = [&](const std::string& ratio) {
    return StudyWarnings(
        ReadBarStudy(folder_.Path(), {{"poisson_ratio: 0.4", "poisson_ratio: " + ratio}}));
  };
  const auto warned = HasSubstr("poisson_ratio is -0.4: an auxetic material");
  EXPECT_THAT(warnings("-0.4"), testing::Contains(warned).Times(1));
  EXPECT_THAT(warnings("0.4"), testing::Not(testing::Contains(HasSubstr("auxetic"))));
}

TEST_F(ReadingAPredictionStudy, WarnsOfImplausibleValuesOnce) {
  const PredictionStudy study =
      ReadBarStudy(folder_.Path(), {{"young_modulus: 0.15 MPa", "young_modulus: 10 GPa"},
                                    {"    clock_deviation",
                                     "    effects: [{type: drag, coefficient: 4000 kg/m^3}]\n"
                                     "    clock_deviation"}});
  EXPECT_THAT(StudyWarnings(study),
              ElementsAre("neo_hookean.young_modulus is 1e+10 Pa; 1000 to 1e+07 is usual for "
                          "soft objects",
                          HasSubstr("bar: drag.coefficient is 4000 kg/m^3; 0 to 300")));
}

TEST_F(ReadingAPredictionStudy, WarnsOfSettingsOfScansWithoutAScan) {
  const auto warnings = [&](const std::string& scan) {
    return StudyWarnings(
        ReadBarStudy(folder_.Path(), {{"noise: 0.05 mm\n", "noise: 0.05 mm\n" + scan}}));
  };
  const auto warned = testing::Contains(HasSubstr("`scan` has no effect"));
  EXPECT_THAT(warnings(""), testing::Not(warned));
  EXPECT_THAT(warnings("scan: {noise: 1 mm}\n"), warned);
}

TEST_F(ReadingAPredictionStudy, TellsOfFramesWithoutMarkers) {
  std::vector<Eigen::Matrix3Xd> markers = Moving(0.001);
  for (const int frame : {12, 13})
    markers[frame].setConstant(std::numeric_limits<double>::quiet_NaN());
  markers[14].col(0).setConstant(std::numeric_limits<double>::quiet_NaN());
  WriteBarRecording(folder_.Path(), markers);
  EXPECT_THAT(StudyWarnings(ReadBarStudy(folder_.Path())),
              ElementsAre("bar: 2 of 26 frames show no marker, the first is frame 12; they are not "
                          "compared"));
}

}  // namespace
}  // namespace lacuna
