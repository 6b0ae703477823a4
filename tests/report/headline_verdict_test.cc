#include "report/headline_verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/reported_models.h"

namespace lacuna {
namespace {

using testing::EndsWith;
using testing::HasSubstr;
using testing::Not;

TEST(HeadlineVerdict, SaysOnlyOfAModelThatMissesTheMarkersThatItWasNotDiagnosed) {
  EXPECT_EQ(VerdictSentence(ModelWithError(8.7e-4, 5.1)),
            "What is missing has not been diagnosed yet; `lacuna diagnose` does so.");
  EXPECT_EQ(VerdictSentence(ModelWithError(2e-4, 1.1)), "");
}

TEST(HeadlineVerdict, AddsTheProbabilityThatThisAloneIsMissing) {
  using Kind = HypothesisProbability::Kind;
  DiagnosisRecord diagnosis = DiagnosisNaming(Verdict::kAmbiguous, {"drag", "clock"});
  EXPECT_EQ(WithProbability(diagnosis, "drag"), "drag of the surrounding medium");
  AddProbability(&diagnosis, {"drag"}, 0.5);
  AddProbability(&diagnosis, {"drag", "clock"}, 0.2);
  AddProbability(&diagnosis, {"drag", "viscoelastic_branch"}, 0.2, Kind::kPair);
  AddProbability(&diagnosis, {"clock"}, 0.1, Kind::kNuisance);
  EXPECT_EQ(WithProbability(diagnosis, "drag"), "drag of the surrounding medium (70 %)");
  EXPECT_EQ(WithProbability(diagnosis, "clock"), "the clock of swing (10 %)");
}

// What is said of an effect counts all hypotheses that contain it.
TEST(HeadlineVerdict, AddsTheProbabilitiesOfAnEffectAloneAndBesideANuisance) {
  using Kind = HypothesisProbability::Kind;
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kMissing, {"drag"});
  AddProbability(&*model.diagnosis, {"drag", "clock"}, 0.7);
  AddProbability(&*model.diagnosis, {"drag"}, 0.2);
  AddProbability(&*model.diagnosis, {"drag", "viscoelastic_branch"}, 0.07, Kind::kPair);
  EXPECT_THAT(VerdictSentence(model), HasSubstr("(probability 97 %)"));
  // Rivals exclude each other.
  model.diagnosis->verdict = Verdict::kAmbiguous;
  model.diagnosis->effects = {"drag", "viscoelastic_branch"};
  AddProbability(&*model.diagnosis, {"viscoelastic_branch"}, 0.03);
  EXPECT_THAT(VerdictSentence(model),
              HasSubstr("drag of the surrounding medium (90 %), or viscoelastic branch (3 %)"));
}

TEST(HeadlineVerdict, StatesTheProbabilityAndTheFamilyBesideAnAdoptedNuisance) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kMissing, {"drag"});
  AddProbability(&*model.diagnosis, {"drag", "clock"}, 0.97);
  model.diagnosis->decision.probabilities[0].family = EffectFamily::kLossOutside;
  EXPECT_THAT(VerdictSentence(model),
              HasSubstr("medium (loss outside the body; probability 97 %)."));
}

// An error of coarse elements is not called noise.
TEST(HeadlineVerdict, SaysWhatTheErrorIsDueToWhereItIsNoNoise) {
  ReportedModel model = ModelWithError(2e-4, 1.9);
  model.diagnosis = DiagnosisNaming(Verdict::kAdequate, {});
  model.diagnosis->errors = model.errors;
  model.diagnosis->errors.without_nuisances = 1.02;
  RecordedNuisance mesh;
  mesh.what = "the size of the elements";
  mesh.advice = "choose a smaller mesh.max_volume";
  mesh.explained = 0.6;
  mesh.adopted = true;
  RecordedNuisance shape;
  shape.name = "shape";
  shape.adopted = true;
  model.diagnosis->nuisances = {shape, mesh};
  EXPECT_EQ(VerdictSentence(model),
            "No further effect is needed: corrected for the size of the elements, the error is 1.0 "
            "times the noise: choose a smaller mesh.max_volume.");
  model.diagnosis->errors.without_nuisances = 1.8;
  EXPECT_THAT(VerdictSentence(model), HasSubstr("is that of the noise, or no larger"));
}

// "Nothing is missing" says nothing about an effect that the fitted parameters imitate.
TEST(HeadlineVerdict, NamesEffectsThatWouldHaveStayedHidden) {
  ReportedModel model = ModelWithError(2e-4, 1.1);
  model.diagnosis = DiagnosisNaming(Verdict::kAdequate, {});
  const auto add = [&](const std::string& title, double detectable, double plausible) {
    RecordedEffect& effect = model.diagnosis->ranking.emplace_back();
    effect.type = effect.title = title;
    effect.sizes = {{"size", "1"}};
    effect.sizes[0].detectable = detectable;
    effect.sizes[0].plausible = plausible;
  };
  add("seen", 0.9, 10);
  add("not tried", INFINITY, NAN);
  EXPECT_THAT(VerdictSentence(model), Not(HasSubstr("Not every")));
  add("imitated", INFINITY, 10);
  add("weak", 1.1, 10);
  EXPECT_THAT(
      VerdictSentence(model),
      HasSubstr(" Not every further effect would have been noticed: imitated and weak could "
                "have a tenth of the largest plausible size."));
  std::vector<RecordedSize>& sizes = model.diagnosis->ranking.back().sizes;
  sizes.push_back(sizes.front());
  sizes.back().detectable = 0.9;
  EXPECT_THAT(VerdictSentence(model), HasSubstr("noticed: imitated could"))
      << "one direction shows";
  model.calibration.parameters.emplace_back().name = "imitated.size";
  EXPECT_THAT(VerdictSentence(model), HasSubstr("noticed: another imitated could"));
  model.calibration.parameters.pop_back();
  model.calibration.held = {{"imitated.size", "1", {0}}};
  EXPECT_THAT(VerdictSentence(model), HasSubstr("noticed: another imitated could"));
  model.calibration.held.clear();
  for (const char* title : {"one", "two", "three", "four"}) add(title, 20, 10);
  EXPECT_THAT(VerdictSentence(model), HasSubstr("noticed: imitated, one, two and 2 others could"));
}

// What no fit may correct can look like a missing effect.
TEST(HeadlineVerdict, DoubtsANameBesideAHeldModulus) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kMissing, {"drag"});
  const std::string doubt = "Young's modulus was not fitted: if 2e+06 Pa is wrong, an effect may";
  EXPECT_THAT(VerdictSentence(model), Not(HasSubstr("not fitted")));
  model.calibration.held = {{"density", "kg/m^3", {1000}}, {"young_modulus", "Pa", {2e6}}};
  EXPECT_THAT(VerdictSentence(model), HasSubstr(doubt));
  model.diagnosis = DiagnosisNaming(Verdict::kAdequate, {});
  EXPECT_THAT(VerdictSentence(model), Not(HasSubstr("not fitted")));
}

TEST(HeadlineVerdict, AnAmbiguousVerdictNamesTheSetAndTheExperiment) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kAmbiguous, {"viscoelastic_branch", "drag"});
  model.diagnosis->next_steps = {SeparateLookAlikes{"drag"}};
  AddProbability(&*model.diagnosis, {"viscoelastic_branch"}, 0.6);
  AddProbability(&*model.diagnosis, {"drag"}, 0.4);
  EXPECT_EQ(VerdictSentence(model),
            "Something is missing, but these recordings cannot tell which of these: viscoelastic "
            "branch (60 %), or drag of the surrounding medium (40 %). To decide: Film it in a "
            "vacuum. `lacuna plan` computes which recording would.");
  // Recordings of scans cannot be planned.
  model.calibration.recordings[0].scan.emplace();
  EXPECT_THAT(VerdictSentence(model), EndsWith("To decide: Film it in a vacuum."));
}

TEST(HeadlineVerdict, EveryOtherVerdictHasItsSentence) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kNuisance, {"clock"});
  EXPECT_EQ(VerdictSentence(model),
            "No physical effect needs to be missing: an error of the measurement or of the "
            "computation explains it (the clock of swing). What to do: give clock_deviation.");
  model.diagnosis = DiagnosisNaming(Verdict::kNoPower, {});
  EXPECT_THAT(VerdictSentence(model), HasSubstr("nothing can be said about what is missing"));
  model.diagnosis = DiagnosisNaming(Verdict::kNotInLibrary, {});
  EXPECT_THAT(VerdictSentence(model), HasSubstr("no effect of the catalogue explains"));
  model.diagnosis = DiagnosisNaming(Verdict::kAdequate, {});
  EXPECT_THAT(VerdictSentence(model), HasSubstr("No further effect is needed: "));
}

// What is left of the error of coarse elements may look like a grip that reaches further.
TEST(HeadlineVerdict, ANuisanceOfEveryModelThatExplainsMoreComesFirst) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kNuisance, {"grip_extent"});
  std::vector<RecordedNuisance>& nuisances = model.diagnosis->nuisances;
  nuisances = {{"grip_extent", "how far the grips reach", "measure it"},
               {"mesh", "the size of the elements", "choose a smaller mesh.max_volume"},
               {"clock", "the clock", "synchronise it"}};
  nuisances[0].explained = 0.29;
  nuisances[1].explained = 0.75;
  nuisances[1].adopted = true;
  nuisances[2].explained = 0.9;  // neither named nor in the model
  EXPECT_THAT(
      VerdictSentence(model),
      EndsWith("What to do: measure it. But first: choose a smaller mesh.max_volume. In the "
               "model as it is, the size of the elements explains more of the error, 75 %, "
               "of which it may have left a part."));
  nuisances[1].explained = 0.2;
  EXPECT_THAT(VerdictSentence(model), EndsWith("What to do: measure it."));
}

// A name means the recording, or the grip, that has the most evidence.
TEST(HeadlineVerdict, TellsOfTheRecordingThatIsMeant) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kNuisance, {"registration"});
  std::vector<RecordedNuisance>& nuisances = model.diagnosis->nuisances;
  nuisances = {{"registration", "the coordinate system of A", "advice for A"},
               {"registration", "the coordinate system of B", "advice for B"},
               {"registration", "the coordinate system of C", "advice for C"}};
  nuisances[0].evidence = -20;
  nuisances[1].evidence = 900;
  nuisances[2].evidence = 30;
  EXPECT_THAT(VerdictSentence(model), HasSubstr("the coordinate system of B"));
  EXPECT_THAT(VerdictSentence(model), EndsWith("What to do: advice for B."));
}

TEST(HeadlineVerdict, AnEffectThatExplainsAPartIsNotCalledWhatIsMissing) {
  ReportedModel model = ModelWithError(8.7e-4, 5.1);
  model.diagnosis = DiagnosisNaming(Verdict::kNotInLibrary, {"drag"});
  model.diagnosis->reasons = {ResidualRemains{"drag", 0.93, 1.7}};
  AddProbability(&*model.diagnosis, {"drag"}, 0.99);
  EXPECT_EQ(
      VerdictSentence(model),
      "Of all effects of the catalogue, drag of the surrounding medium explains most: 93 % of "
      "the squared error beyond the noise. 1.7 times the noise is left, which no effect "
      "explains: something else is missing, beside it or in its place.");
  // A nuisance may have been taken beside it.
  model.diagnosis->decision.adequacy.beside = {"drag", "clock"};
  EXPECT_THAT(VerdictSentence(model),
              HasSubstr("With the clock of swing beside it, 1.7 times the noise is left"));
}

}  // namespace
}  // namespace lacuna
