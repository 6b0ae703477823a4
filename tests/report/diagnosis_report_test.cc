#include "report/diagnosis_report.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::Not;

RecordedEffect MadeUpEffect(const std::string& type, double evidence) {
  RecordedEffect effect;
  effect.type = effect.title = type;
  effect.first_order.evidence = evidence;
  effect.sizes.push_back({"coefficient", "kg/m^3", 1, 0.1, 0.5, std::nullopt});
  return effect;
}

// Drag is missing; swelling shows no sign.
DiagnosisRecord MissingDrag() {
  DiagnosisRecord record;
  record.verdict = Verdict::kMissing;
  record.effects = {"drag"};
  record.reasons = {EffectReducesError{"drag", 300, true, false, 5, 1}};
  record.noise.coordinate = 1e-4;
  record.errors.has_held_out = true;
  record.errors.held_out_rms = 9e-4;
  record.errors.without_nuisances = 5;
  record.ranking = {MadeUpEffect("drag", 310), MadeUpEffect("swelling", -3)};
  record.ranking[0].sizes[0].refitted = RecordedInterval{2, 1, 3};
  record.ranking[0].refit.emplace().evidence = 300;
  record.ranking[0].refit->errors.without_nuisances = 1;
  return record;
}

TEST(DiagnosisReport, ShowsVerdictReasonsAndNextCommand) {
  const std::string text = DiagnosisReport(MissingDrag(), {}, "runs/bar");
  EXPECT_THAT(text, HasSubstr("\nmissing {drag}\n"));
  EXPECT_THAT(text, HasSubstr("goes from 5.0 σ to 1.0 σ"));
  EXPECT_THAT(text, HasSubstr("2 [1, 3] kg/m^3"));
  EXPECT_THAT(text, HasSubstr("no evidence for: swelling"));
  EXPECT_THAT(text, HasSubstr("next: lacuna add runs/bar drag"));
  EXPECT_THAT(text, Not(HasSubstr("Smallest size")));
}

TEST(DiagnosisReport, ShowsLongTimeStepsInSeconds) {
  DiagnosisRecord record = MissingDrag();
  record.time_step = 0.005;
  EXPECT_THAT(DiagnosisReport(record, {}, "runs/bar"), HasSubstr("Time step: 5 ms."));
  record.time_step = 10;
  EXPECT_THAT(DiagnosisReport(record, {}, "runs/bar"), HasSubstr("Time step: 10 s."));
}

TEST(DiagnosisReport, ShowsWhatWouldHaveBeenSeenWhereNothingIsMissing) {
  DiagnosisRecord record = MissingDrag();
  record.verdict = Verdict::kAdequate;
  record.effects.clear();
  record.ranking[1].sizes[0].detectable = INFINITY;
  const std::string text = DiagnosisReport(record, {}, "runs/bar");
  EXPECT_THAT(text, HasSubstr("Smallest size that these recordings would reveal"));
  EXPECT_THAT(text, HasSubstr("0.5 kg/m^3"));
  EXPECT_THAT(text, HasSubstr("no size would be detectable"));
}

TEST(DiagnosisReport, ShowsFromWhichDataAnEffectRemovesMisfit) {
  DiagnosisRecord record = MissingDrag();
  const auto text = [&](const ByDataKind& removed) {
    record.ranking[0].refit->removed = removed;
    return DiagnosisReport(record, {}, "runs/bar");
  };
  EXPECT_THAT(text({62, 0, 38}), HasSubstr("      of the squared misfit that it removes, 62 % "
                                           "belongs to the markers and 38 % to the forces\n"));
  EXPECT_THAT(text({-2.5, 0, 34}), HasSubstr("      it changes the squared misfit of the markers "
                                             "by +2.5 σ² and that of the forces by -34.0 σ²\n"));
  EXPECT_THAT(text({0, 0, 0}), Not(HasSubstr("squared misfit that")));
  record.ranking[0].refit->removed.reset();  // one kind of data, or a diagnosis of earlier versions
  EXPECT_THAT(DiagnosisReport(record, {}, "runs/bar"), Not(HasSubstr("that it removes")));
}

TEST(DiagnosisReport, SuggestsAPlanWhereARecordingCanBePlanned) {
  DiagnosisRecord record = MissingDrag();
  record.verdict = Verdict::kAmbiguous;
  record.effects = {"drag", "swelling"};
  record.next_steps = {SeparateLookAlikes{"drag"}};
  CalibrationRecord fit;
  fit.recordings.resize(1);
  EXPECT_THAT(DiagnosisReport(record, fit, "runs/bar"), HasSubstr("lacuna plan runs/bar"));
  fit.recordings[0].scan.emplace();
  EXPECT_THAT(DiagnosisReport(record, fit, "runs/bar"), Not(HasSubstr("lacuna plan")));
}

TEST(DiagnosisReport, ShowsWhyARefitIsNotUsable) {
  DiagnosisRecord record = MissingDrag();
  record.ranking[0].refit->message = "no step could be taken";
  const std::string text = DiagnosisReport(record, {}, "runs/bar");
  EXPECT_THAT(text, HasSubstr("not usable"));
  EXPECT_THAT(text, HasSubstr("no step could be taken"));
}

TEST(DiagnosisReport, MarksASizeAtTheLimitOfWhatIsPlausible) {
  DiagnosisRecord record = MissingDrag();
  const std::string mark =
      "      coefficient is at the limit of what is plausible, where its interval is cut off\n";
  EXPECT_THAT(DiagnosisReport(record, {}, "runs/bar"), Not(HasSubstr(mark)));
  record.ranking[0].sizes[0].at_limit = true;
  EXPECT_THAT(DiagnosisReport(record, {}, "runs/bar"), HasSubstr(mark));
}

TEST(DiagnosisReport, ShowsWhyARefitHasNotConverged) {
  DiagnosisRecord record = MissingDrag();
  record.ranking[0].refit->unconverged = "the search was ended";
  const std::string text = DiagnosisReport(record, {}, "runs/bar");
  EXPECT_THAT(text, HasSubstr("      the search was ended\n"));
  EXPECT_THAT(text, HasSubstr("2 [1, 3] kg/m^3")) << "the refit counts";
}

}  // namespace
}  // namespace lacuna
