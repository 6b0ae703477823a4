#include "report/headline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/reported_models.h"

namespace lacuna {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;
using testing::SizeIs;

void Compare(ReportedModel* model) {
  ComparedPart part;
  part.fitted = false;
  part.error.rms = 1;
  part.worst_point = 1;
  part.worst_period = WorstPeriod{30, 40, 11, 0.3, 0.4, 1e-3, {}};
  ComparedRecording recording;
  recording.name = "swing";
  recording.point_names = {"root", "tip"};
  recording.parts = {part};
  model->comparison.emplace().recordings = {recording};
}

TEST(Headline, TellsTheErrorWhatIsMissingAndWhatAddingItDid) {
  ReportedModel before = ModelWithError(8.7e-4, 5.1);
  Compare(&before);
  before.diagnosis = DiagnosisNaming(Verdict::kMissing, {"viscoelastic_branch"});
  AddProbability(&*before.diagnosis, {"viscoelastic_branch"}, 0.992);
  before.diagnosis->decision.probabilities[0].family = EffectFamily::kLossInside;
  ReportedModel after = ModelWithError(1.9e-4, 1.2);
  after.added = "viscoelastic_branch";
  after.diagnosis = DiagnosisNaming(Verdict::kAdequate, {});
  AddProbability(&*after.diagnosis, {}, 0.58, HypothesisProbability::Kind::kNothing);
  AddProbability(&*after.diagnosis, {"clock"}, 0.2, HypothesisProbability::Kind::kNuisance);
  EXPECT_THAT(
      Headline({before, after}),
      ElementsAre(
          "The model misses the markers by 0.870 mm, 5.1 times the noise, in frames that it was "
          "not fitted to; the error is largest at marker tip and from 0.3 s to 0.4 s.",
          "What it lacks: viscoelastic branch (loss inside the body; probability 99 %).",
          "With viscoelastic branch, the error falls by 78 % to 0.190 mm, 1.2 times the noise.",
          "No further effect is needed (probability that no effect is missing: 78 %): the error "
          "that "
          "is left is that of the noise, or no larger than the error of any model."));
}

RecordedEffect Drag() {
  RecordedEffect drag;
  drag.type = "drag";
  drag.title = "Drag";
  drag.sizes = {{"coefficient", "kg/m^3"}};
  return drag;
}

// With its 95 % interval.
FittedParameter DragCoefficient(double low, double high) {
  FittedParameter parameter;
  parameter.name = "drag.coefficient";
  parameter.estimate.low = low;
  parameter.estimate.high = high;
  return parameter;
}

// The diagnosis with drag names swelling, beside which the drag may be zero.
TEST(Headline, SaysWhichAddedEffectMayBeLeftOut) {
  ReportedModel first = ModelWithError(4e-4, 2.4);
  first.diagnosis = DiagnosisNaming(Verdict::kMissing, {"drag"});
  first.diagnosis->ranking = {Drag()};
  ReportedModel second = ModelWithError(2e-4, 1.2);
  second.added = "drag";
  second.diagnosis = DiagnosisNaming(Verdict::kMissing, {"swelling"});
  ReportedModel third = ModelWithError(1e-4, 0.6);
  third.added = "swelling";
  second.calibration.parameters = third.calibration.parameters = {DragCoefficient(2, 3)};
  const std::string told = "Beside what was added later, drag may be zero: it may be left out.";
  EXPECT_THAT(Headline({first, second, third}), Not(Contains(told)));
  third.calibration.parameters[0].estimate.low = -1;
  EXPECT_THAT(Headline({first, second, third}), Contains(told));
  // A model whose own addition does not count says nothing of the others.
  RecordedEffect swelling;
  swelling.type = "swelling";
  swelling.sizes = {{"strain", "1"}};
  second.diagnosis->ranking = {swelling};
  FittedParameter& strain = third.calibration.parameters.emplace_back();
  strain.name = "swelling.strain";
  strain.estimate.low = -1;
  strain.estimate.high = 1;
  EXPECT_THAT(Headline({first, second, third}), Not(Contains(told)));
}

TEST(Headline, SaysThatAnEffectWhoseSizeMayBeZeroDoesNotCount) {
  ReportedModel before = ModelWithError(2e-4, 1.2);
  before.diagnosis = DiagnosisNaming(Verdict::kMissing, {"drag"});
  AddProbability(&*before.diagnosis, {"drag"}, 0.98);
  before.diagnosis->ranking = {Drag()};
  ReportedModel after = ModelWithError(1.9e-4, 1.15);
  after.added = "drag";
  after.calibration.parameters = {DragCoefficient(0, 3)};
  EXPECT_EQ(
      Headline({before, after}).back(),
      "The diagnosis names drag (98 %), but once it is fitted, its size may be zero, so that it "
      "does not count.");
  const ReportedModel first = ModelWithError(4e-4, 2.4);
  EXPECT_THAT(Headline({first, before, after}).back(), HasSubstr("A further diagnosis names drag"));
  // An effect that was added although the diagnosis has not named it alone.
  before.diagnosis->verdict = Verdict::kAmbiguous;
  before.diagnosis->effects = {"drag", "viscoelastic_branch"};
  EXPECT_THAT(Headline({before, after}),
              ElementsAre(HasSubstr("The model meets"), HasSubstr("cannot tell which of these"),
                          "A model with drag was fitted, too, but its size may be zero, so that it "
                          "does not count."));
  after.calibration.parameters[0].estimate.low = 1;
  EXPECT_THAT(Headline({before, after}).back(), HasSubstr("With drag, the error falls by 5 % to"));
  after.errors.held_out_rms = 2.1e-4;
  EXPECT_THAT(Headline({before, after}).back(), HasSubstr("With drag, the error is 0.210 mm"));
  before.errors.held_out_at_measured_places = 5e-4;
  after.errors.held_out_at_measured_places = 3e-4;
  EXPECT_THAT(Headline({before, after}).back(),
              HasSubstr("where they were measured, it falls from 0.500 mm to 0.300 mm"));
}

TEST(Headline, NamesTheRecordingOfTheLargestErrorWhereThereAreSeveral) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  Compare(&model);
  model.comparison->recordings.push_back(model.comparison->recordings[0]);
  EXPECT_THAT(Headline({model}).at(0), HasSubstr("from 0.3 s to 0.4 s of recording swing."));
  model.comparison->recordings[0].name = "recording 1";
  EXPECT_THAT(Headline({model}).at(0), HasSubstr("from 0.3 s to 0.4 s of recording 1."));
}

TEST(Headline, SaysThatItWasNotDiagnosedAndNotCompared) {
  EXPECT_THAT(
      Headline({ModelWithError(8.7e-4, 5.1)}),
      ElementsAre("The model misses the markers by 0.870 mm, 5.1 times the noise, in "
                  "frames that it was not fitted to.",
                  "What is missing has not been diagnosed yet; `lacuna diagnose` does so."));
  ReportedModel fitted = ModelWithError(2e-4, 1.1);
  fitted.errors.has_held_out = false;
  fitted.calibration.recordings[0].scan.emplace();
  EXPECT_THAT(Headline({fitted}), ElementsAre("The model meets the scans to within 0.200 mm, 1.1 "
                                              "times the noise, in frames that it was fitted to."));
}

// A diagnosis of some recordings says nothing about what others would ask for.
TEST(Headline, SaysWhichRecordingsAreNotMetAlthoughNothingMoreIsMissingInTheOthers) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kAdequate, {});
  EXPECT_THAT(Headline({model}), SizeIs(2));
  model.calibration.recordings.resize(3);
  model.calibration.recordings[1].name = "repeat";
  model.calibration.recordings[1].fitted = false;
  model.calibration.recordings[1].held_out.rms_over_sigma = 1.05;
  model.calibration.recordings[1].held_out.points = 9;
  model.calibration.recordings[2].name = "52 g";
  model.calibration.recordings[2].fitted = false;
  model.calibration.recordings[2].held_out.rms_over_sigma = 14.04;
  model.calibration.recordings[2].held_out.points = 9;
  EXPECT_EQ(Headline({model}).at(2),
            "That holds for the recordings that were fitted. Of the others, the model does not "
            "meet these to within the noise: 52 g (14.0 times the noise). To have them diagnosed, "
            "set `fitted: true` in a copy of the experiment.");
  model.calibration.recordings[1].held_out.points = 0;
  EXPECT_THAT(Headline({model}).at(2), HasSubstr("repeat (it could not be simulated), 52 g"));
  model.diagnosis = DiagnosisNaming(Verdict::kMissing, {"drag"});
  EXPECT_THAT(Headline({model}), SizeIs(2));
}

TEST(Headline, SaysThatAMeasuredForceIsMissedByFarMoreThanTheMarkers) {
  ReportedModel model = ModelWithError(3.1e-5, 0.9);
  FittedReaction force;
  force.name = "jaw";
  force.largest_reading = 2;
  force.in_fit = {19, 19, 0.01, 0.02, 2.5};
  model.calibration.recordings[0].reactions = {force};
  EXPECT_THAT(Headline({model}), SizeIs(1));

  FittedReaction& reaction = model.calibration.recordings[0].reactions[0];
  reaction.in_fit = {19, 19, 0.01, 0.02, 12};
  EXPECT_EQ(Headline({model}).at(1),
            "But it misses the force on jaw by 0.01 N, 12.0 times its noise.");
  reaction.in_fit = {19, 19, 0.9, 2, 505};
  EXPECT_EQ(
      Headline({model}).at(1),
      "But it misses the force on jaw by 0.9 N, 505.0 times its noise. Before an effect is looked "
      "for, the load cell should be checked: another sign (`exerted_by`), an offset "
      "(`tare_deviation`), a delay (`delay_deviation`) or another unit of its reading would look "
      "like this.");
  reaction.tare_deviation = 0.1;
  EXPECT_THAT(Headline({model}).at(1), testing::Not(HasSubstr("tare")));
  // An effect that has been named explains the reading, unless a mistake fits.
  ReportedModel diagnosed = model;
  diagnosed.diagnosis = DiagnosisNaming(Verdict::kMissing, {"viscoelastic_branch"});
  EXPECT_EQ(Headline({diagnosed}).at(1),
            "But it misses the force on jaw by 0.9 N, 505.0 times its noise.");
  diagnosed.calibration.recordings[0].reactions[0].likely_mistakes.factor = -1;
  EXPECT_THAT(Headline({diagnosed}).at(1), HasSubstr("opposite sign"));
  reaction.likely_mistakes.factor = -3e4;
  EXPECT_THAT(Headline({model}).at(1),
              EndsWith("checked: its reading would fit with the opposite sign (`exerted_by`)."));
  reaction.likely_mistakes = {{}, 0.4, -0.2};
  EXPECT_THAT(Headline({model}).at(1),
              EndsWith("would fit with an offset of 0.4 N (`tare_deviation`), or if it came 200 ms "
                       "early (`delay_deviation`)."));
  reaction.likely_mistakes = {9.81, -0.333, {}};
  EXPECT_THAT(Headline({model}).at(1),
              EndsWith("would fit if it were 9.81 times the force plus an offset of -0.333 N, as "
                       "if the load or the reading were in another unit."));
  // Markers that are missed as well.
  model.errors.rms_over_sigma = 200;
  EXPECT_THAT(Headline({model}), SizeIs(2));
  EXPECT_THAT(Headline({model}).at(1), testing::Not(HasSubstr("jaw")));
}

TEST(Headline, NamesAConflictOfMoreThanTenStandardDeviations) {
  ReportedModel model = ModelWithError(3.1e-5, 0.9);
  model.calibration.prior_conflicts = {
      MarkerConflict{"swing", "root", Eigen::Vector3d(9.9e-4, 0, 0), 1e-4},
      NuisanceParameterConflict{"swing.clock", 4}};
  EXPECT_THAT(Headline({model}), SizeIs(1));
  model.calibration.prior_conflicts.emplace_back(
      MarkerConflict{"swing", "tip", Eigen::Vector3d(0, 3e-2, 0), 1e-4});
  EXPECT_EQ(Headline({model}).at(1),
            "The fit contradicts what the files say by 300 standard deviations, which should be "
            "checked first: swing: the fit places marker tip (0, 30, 0) mm away from its recorded "
            "place on the undeformed object; place_deviation is 0.1 mm.");
}

TEST(Headline, NamesTheParameterThatADefaultPriorHoldsBackMost) {
  ReportedModel model = ModelWithError(3.1e-5, 0.9);
  model.calibration.prior_conflicts = {
      ModelParameterConflict{"young_modulus", "Pa", 9, 1e5, /*is_default=*/false}};
  EXPECT_THAT(Headline({model}), SizeIs(1));
  model.calibration.prior_conflicts = {
      ModelParameterConflict{"mass_damping.alpha", "1/s", 3.2, 1, /*is_default=*/true},
      ModelParameterConflict{"stiffness_damping.beta", "s", 12, 0.001, /*is_default=*/true}};
  const std::vector<std::string> sentences = Headline({model});
  ASSERT_THAT(sentences, SizeIs(2));
  EXPECT_THAT(sentences[1], testing::StartsWith("A default prior may distort the fit: "
                                                "stiffness_damping.beta is 12.0 standard"));
}

TEST(Headline, AFitThatFailedIsNotCalledAModel) {
  ReportedModel failed = ModelWithError(0, 0);
  failed.calibration.usable = false;
  failed.calibration.message = "an element inverted";
  EXPECT_THAT(Headline({failed}), ElementsAre("The fit did not succeed: an element inverted."));
  ReportedModel before = ModelWithError(8.7e-4, 5.1);
  before.diagnosis = DiagnosisNaming(Verdict::kMissing, {"drag"});
  failed.added = "drag";
  const std::vector<std::string> sentences = Headline({before, failed});
  ASSERT_THAT(sentences, SizeIs(3));
  EXPECT_EQ(sentences[2],
            "The model with drag of the surrounding medium could not be fitted: an element "
            "inverted.");
}

}  // namespace
}  // namespace lacuna
