#include "report/verdict_text.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace lacuna {
namespace {

using testing::HasSubstr;

// A record with the effects drag and gravity, and with the nuisances mesh (0) and jitter (1).
DiagnosisRecord SmallDiagnosis() {
  DiagnosisRecord record;
  record.ranking.resize(2);
  record.ranking[0].type = "drag";
  record.ranking[0].title = "Drag of the air";
  record.ranking[0].separating_experiment = "film it in vacuum";
  record.ranking[1].type = "gravity";
  record.ranking[1].title = "Gravity";
  record.nuisances.resize(2);
  record.nuisances[0].name = "mesh";
  record.nuisances[0].what = "the coarse mesh";
  record.nuisances[0].advice = "choose a smaller mesh.max_volume";
  record.nuisances[1].name = "time_jitter";
  record.nuisances[1].what = "the times of the frames";
  record.nuisances[1].advice = "check the camera's clock";
  return record;
}

TEST(VerdictText, NamesWhatTheVerdictNames) {
  DiagnosisRecord record = SmallDiagnosis();
  record.verdict = Verdict::kNotInLibrary;
  EXPECT_EQ(VerdictWithNames(record), "not in library");
  record.verdict = Verdict::kAmbiguous;
  record.effects = {"drag", "time_jitter"};
  EXPECT_EQ(VerdictWithNames(record), "ambiguous {drag, time_jitter}");
  EXPECT_EQ(ExplainVerdict(record),
            "These recordings cannot distinguish between: Drag of the air; the times of the "
            "frames.");
}

TEST(VerdictText, LabelsTheModelsOfASequence) {
  const DiagnosisRecord record = SmallDiagnosis();
  EXPECT_EQ(ModelLabel(0, "", std::nullopt), "initial model");
  EXPECT_EQ(ModelLabel(1, "drag", record), "with drag of the air");
  EXPECT_EQ(ModelLabel(2, "gravity", record), "and with gravity");
  EXPECT_EQ(ModelLabel(2, "drag", std::nullopt), "and with drag");
}

TEST(VerdictText, SaysHowMuchTheMissingEffectReducesTheError) {
  DiagnosisRecord record = SmallDiagnosis();
  record.verdict = Verdict::kMissing;
  record.effects = {"drag"};
  record.reasons = {EffectReducesError{"drag", 300, true, false, 5, 1}};
  EXPECT_EQ(ExplainVerdict(record),
            "Missing: Drag of the air. With drag, the held-out error goes from 5.0 σ to 1.0 σ; the "
            "evidence for it is 300.");
  record.reasons = {EffectReducesError{"drag", 300, false, true, 5, 1}};
  EXPECT_THAT(ExplainVerdict(record),
              HasSubstr("the fitted error, excluding the contributions of mesh, time step"));
  EXPECT_EQ(DescribeNextSteps(record), "");
}

// Both levels: the family, and its members.
TEST(VerdictText, StatesProbabilitiesOfFamiliesAndMembers) {
  DiagnosisRecord record = SmallDiagnosis();
  record.verdict = Verdict::kAmbiguous;
  record.effects = {"drag", "mass_damping"};
  using Kind = HypothesisProbability::Kind;
  record.decision.probabilities = {
      {Kind::kEffect, {"drag"}, EffectFamily::kLossOutside, 20, 0.62},
      {Kind::kEffect, {"mass_damping"}, EffectFamily::kLossOutside, 19.5, 0.37},
      {Kind::kNothing, {}, EffectFamily::kOther, 0, 0.004}};
  record.decision.adequacy.beside = {"drag"};
  record.decision.adequacy.p = 0.4;
  EXPECT_THAT(ExplainVerdict(record),
              HasSubstr("loss outside the body 99 % (drag 62 %, mass_damping 37 %). The model with "
                        "drag leaves nothing that is more probable than noise and the error of the "
                        "model (p = 0.4)."));
  record.decision.adequacy.is_adequate = false;
  record.decision.adequacy.p = 0.001;
  record.decision.adequacy.left_share = 0.25;
  EXPECT_THAT(ExplainVerdict(record), HasSubstr("Something unknown is left"));
  EXPECT_THAT(ExplainVerdict(record), HasSubstr("25.0 % of what was explained"));
  record.decision.adequacy.left_share = 0.004;
  record.decision.adequacy.is_tolerated = true;
  EXPECT_THAT(ExplainVerdict(record),
              HasSubstr("0.4 % of the squared misfit that was explained: no more than the error of "
                        "any model"));
}

// A pair that is refuted says nothing against its effects.
TEST(VerdictText, SaysWhichEffectsAreRefuted) {
  DiagnosisRecord record = SmallDiagnosis();
  using Kind = HypothesisProbability::Kind;
  record.ranking[0].refit.emplace().evidence = 40;
  HypothesisProbability refuted;
  refuted.is_refuted = true;
  refuted.kind = Kind::kPair;
  refuted.names = {"drag", "gravity"};
  record.decision.probabilities = {refuted};
  EXPECT_THAT(ExplainVerdict(record), testing::Not(HasSubstr("refuted")));
  refuted.kind = Kind::kEffect;
  refuted.names = {"drag"};
  record.decision.probabilities.push_back(refuted);
  EXPECT_THAT(ExplainVerdict(record), HasSubstr("drag is refuted"));
  // An effect that is refuted beside a nuisance, too, is refuted once.
  refuted.names = {"drag", "time_jitter"};
  record.decision.probabilities.push_back(refuted);
  const std::string text = ExplainVerdict(record);
  EXPECT_EQ(text.find("drag is refuted"), text.rfind("drag is refuted"));
  EXPECT_THAT(text, HasSubstr("drag is refuted"));
  // One that is refuted beside a nuisance, but not in its place, is not.
  record.decision.probabilities[1].is_refuted = false;
  EXPECT_THAT(ExplainVerdict(record), testing::Not(HasSubstr("refuted")));
}

TEST(VerdictText, SaysWhyAnEffectAtTheLimitIsNotRefuted) {
  DiagnosisRecord record = SmallDiagnosis();
  HypothesisProbability drag;
  drag.kind = HypothesisProbability::Kind::kEffect;
  drag.names = {"drag"};
  record.decision.probabilities = {drag};
  record.ranking[0].refit.emplace().evidence = 40;
  EXPECT_THAT(ExplainVerdict(record), testing::Not(HasSubstr("refuted")));
  record.ranking[0].refit->fails_at_limit = true;
  EXPECT_THAT(ExplainVerdict(record),
              HasSubstr("drag is not refuted: its size is at the limit of what is plausible. "));
}

TEST(VerdictText, SaysThatTheResidualIsUnexplained) {
  DiagnosisRecord record = SmallDiagnosis();
  record.verdict = Verdict::kNotInLibrary;
  record.reasons = {ErrorUnexplained{1e-3, 10, 2}, NuisanceExplains{1, 0.3}};
  EXPECT_EQ(ExplainVerdict(record),
            "The residual, 1.000 mm or 10.0 σ, exceeds the noise, and no effect of the catalogue "
            "explains it (best evidence 2.0). 30 % of the squared misfit is explained by the times "
            "of the frames: check the camera's clock.");
  record.reasons = {EvidenceForAnother{"drag", 300, "gravity", 16}};
  record.next_steps = {AddAndDiagnose{"drag", "gravity"}};
  EXPECT_THAT(ExplainVerdict(record), HasSubstr("beside it the evidence for gravity is 16"));
  EXPECT_THAT(DescribeNextSteps(record), HasSubstr("add drag and diagnose again"));
}

TEST(VerdictText, SaysBesideWhatTheRestWasMeasured) {
  DiagnosisRecord record = SmallDiagnosis();
  record.verdict = Verdict::kNotInLibrary;
  record.reasons = {ResidualRemains{"drag", 0.9, 1.4}};
  EXPECT_THAT(ExplainVerdict(record), HasSubstr("1.4 σ remain: it may be present"));
  record.decision.adequacy.beside = {"drag", "time_jitter"};
  EXPECT_THAT(ExplainVerdict(record), HasSubstr("1.4 σ remain with time_jitter beside it: it may"));
}

TEST(VerdictText, SuggestsAnExperimentOrACheck) {
  DiagnosisRecord record = SmallDiagnosis();
  record.next_steps = {SeparateLookAlikes{"drag"}, CheckNuisance{1}};
  EXPECT_EQ(DescribeNextSteps(record), "film it in vacuum; or check the camera's clock");
}

TEST(VerdictText, HasASentenceForEveryReason) {
  DiagnosisRecord record = SmallDiagnosis();
  const std::vector<VerdictReason> all{NothingDetectable{}, ErrorIsNoise{},    ErrorUnexplained{},
                                       NuisanceExplains{},  ResidualRemains{}, EvidenceForAnother{},
                                       EffectReducesError{}};
  ASSERT_EQ(all.size(), std::variant_size_v<VerdictReason>);
  for (const VerdictReason& reason : all) {
    record.reasons = {reason};
    EXPECT_THAT(ExplainVerdict(record), testing::EndsWith(".")) << reason.index();
  }
}

}  // namespace
}  // namespace lacuna
