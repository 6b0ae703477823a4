#include "diagnosis/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "diagnosis/recorded_diagnosis.h"
#include "effects/catalogue.h"
#include "report/verdict_text.h"

namespace lacuna {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

std::string Explanation(const Diagnosis& diagnosis) { return ExplainVerdict(RecordOf(diagnosis)); }

// The first reason of this kind, or null.
template <typename Reason>
const Reason* FindReason(const Diagnosis& diagnosis) {
  for (const VerdictReason& reason : diagnosis.reasons)
    if (const auto* found = std::get_if<Reason>(&reason)) return found;
  return nullptr;
}

constexpr double kEvidence = 1000;  // of the nuisance

// A time error of each frame explains everything. Mass damping in its place has `evidence`, and
// changes the held-out error from 10 σ to `error`.
Diagnosis DelayedFrames(double evidence, double error) {
  Diagnosis diagnosis;
  diagnosis.verdict = Verdict::kNuisance;
  diagnosis.effects = {"time_jitter"};
  diagnosis.errors.has_held_out = true;
  ScoredNuisance& jitter = diagnosis.nuisances.emplace_back();
  jitter.candidate.card.name = "time_jitter";
  jitter.candidate.card.advice = "check the camera's clock";
  jitter.evidence = kEvidence;
  jitter.adopted = true;
  diagnosis.alternatives.nuisances_evidence = kEvidence;
  diagnosis.alternatives.bare.without_nuisances = 10;
  RankedEffect& damping = diagnosis.alternatives.effects.emplace_back();
  damping.scored.candidate.type = "mass_damping";
  damping.scored.candidate.effect = MakeEffect("mass_damping", {{"alpha", 10}});
  damping.refitted = true;
  damping.evidence = evidence;
  damping.errors.without_nuisances = error;
  return diagnosis;
}

// A point force has twice the evidence of gravity. The arguments are their errors on a recording
// that was not fitted, σ.
Diagnosis SaggingBeam(double with_point_force, double with_gravity) {
  Diagnosis diagnosis;
  diagnosis.errors.has_held_out = true;
  diagnosis.errors.without_nuisances = diagnosis.baseline_rms_over_sigma = 5;
  diagnosis.best_rms_over_sigma = 1;
  const auto add = [&](const std::string& type, double evidence, double error) {
    RankedEffect& effect = diagnosis.ranking.emplace_back();
    CandidateEffect& candidate = effect.scored.candidate;
    candidate.type = type;
    candidate.effect = FindEntry(type)->make(
        Eigen::VectorXd::Ones(static_cast<Eigen::Index>(FindEntry(type)->card->parameters.size())));
    candidate.amplitude = {0, 1, 2};
    effect.scored.score.detectable = Eigen::Vector3d::Constant(1e-3);
    effect.refitted = true;
    effect.evidence = evidence;
    effect.rms_over_sigma = effect.errors.without_nuisances = 1;
    effect.errors.unfitted_rms_over_sigma = error;
  };
  add("point_force", 300, with_point_force);
  add("gravity", 150, with_gravity);
  return diagnosis;
}

TEST(Verdict, NamesTheEffectWithFarMoreEvidence) {
  Diagnosis diagnosis = SaggingBeam(12, 12);
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << Explanation(diagnosis);
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force"));
}

// Where the model is at the noise already, an effect whose size may be 0 is not named.
TEST(Verdict, NamesNoEffectWhoseSizeMayBeNone) {
  Diagnosis diagnosis = SaggingBeam(1, 1);
  ParameterEstimate size;
  size.value = 3;
  size.low = -1;
  size.high = 7;
  for (RankedEffect& effect : diagnosis.ranking) effect.sizes.assign(3, size);
  Diagnosis at_noise = diagnosis;
  at_noise.errors.rms_over_sigma = at_noise.errors.without_nuisances =
      at_noise.baseline_rms_over_sigma = 1.1;
  Diagnosis certain = at_noise;
  at_noise.ranking[0].evidence = 9;
  at_noise.ranking[1].evidence = 2;
  Diagnosis sure = at_noise;
  Decide(&at_noise);
  EXPECT_EQ(at_noise.verdict, Verdict::kAdequate) << Explanation(at_noise);
  sure.ranking[0].sizes[1].low = 1;
  Decide(&sure);
  EXPECT_EQ(sure.verdict, Verdict::kMissing) << Explanation(sure);
  EXPECT_THAT(sure.effects, ElementsAre("point_force"));
  // With so much evidence, the interval means little.
  Decide(&certain);
  EXPECT_EQ(certain.verdict, Verdict::kMissing) << Explanation(certain);
  // Far from the noise, the evidence decides.
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << Explanation(diagnosis);
}

// An effect whose held-out error stays far above the noise does not predict.
TEST(Verdict, DoesNotNameAnEffectThatPredictsPoorly) {
  Diagnosis diagnosis = SaggingBeam(12, 12);
  diagnosis.errors.without_nuisances = 2;
  diagnosis.ranking[0].errors.without_nuisances = 1.25;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << Explanation(diagnosis);
  diagnosis.ranking[0].errors.without_nuisances = 1.6;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary);
  // It removes nearly all of a much larger error.
  diagnosis.errors.without_nuisances = 6;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << Explanation(diagnosis);
  // A rival that explains as much does predict.
  diagnosis.errors.without_nuisances = 2;
  diagnosis.ranking[1].evidence = 295;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
}

// Beside the best effect, another one has much evidence.
TEST(Verdict, DoesNotNameAnEffectThatLeavesMoreThanChanceForAnother) {
  Diagnosis diagnosis = SaggingBeam(12, 12);
  diagnosis.ranking[0].further = {"drag", 14};
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << "a twentieth of 300 is 15";
  diagnosis.ranking[0].further.evidence = 16;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary);
  const auto* another = FindReason<EvidenceForAnother>(diagnosis);
  ASSERT_NE(another, nullptr);
  EXPECT_EQ(another->other, "drag");
  EXPECT_EQ(another->other_evidence, 16);
  // A rival that explains as much leaves no evidence.
  diagnosis.effects.clear();
  diagnosis.ranking[1].evidence = 295;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force", "gravity"));
  diagnosis.effects.clear();
  diagnosis.ranking[1].further = {"drag", 40};
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary);
  // Where a nuisance explains the remainder as well, it is no other effect.
  diagnosis.effects.clear();
  diagnosis.ranking[1].evidence = 150;
  diagnosis.ranking[0].further.nuisance_evidence = 15;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << Explanation(diagnosis);
  diagnosis.ranking[0].further.nuisance_evidence = 0;
  // What the uncertainty of the mesh could account for is no evidence.
  diagnosis.nuisances.emplace_back().uncertain_evidence = 20;
  diagnosis.ranking[1].evidence = 150;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << Explanation(diagnosis);
}

// An effect with held-out evidence against it is not named first, and may still be a rival.
TEST(Verdict, DoesNotRuleOutARivalByTheHeldOutFramesAlone) {
  Diagnosis diagnosis = SaggingBeam(12, 12);
  diagnosis.ranking[1].evidence = 295;
  diagnosis.ranking[1].held_out_evidence = -10;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force", "gravity"));
  diagnosis.ranking[1].evidence = 305;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force", "gravity"));
}

// An absent effect has size 0 and evidence 0: a refit with negative evidence has failed.
TEST(Verdict, DoesNotRuleOutWhatCouldNotBeFitted) {
  Diagnosis diagnosis = SaggingBeam(12, 12);
  diagnosis.ranking[0].scored.score.evidence = 310;
  diagnosis.ranking[1].scored.score.evidence = 305;
  diagnosis.ranking[1].evidence = -20;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force", "gravity"));
  diagnosis.ranking[1].scored.score.evidence = 200;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << Explanation(diagnosis);
}

TEST(Verdict, DoesNotRuleOutWhatPredictsOtherRecordingsBetter) {
  Diagnosis as_good = SaggingBeam(12, 11.99);
  Decide(&as_good);
  EXPECT_EQ(as_good.verdict, Verdict::kMissing);
  Diagnosis diagnosis = SaggingBeam(12, 11);
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force", "gravity"));
  const auto* better = FindReason<RivalPredictsBetter>(diagnosis);
  ASSERT_NE(better, nullptr);
  EXPECT_EQ(better->effect, "gravity");
  EXPECT_EQ(better->over_sigma, 11);
  EXPECT_EQ(better->over_sigma_of_best, 12);
}

// The uncertain change by a finer mesh could be what the effect explains.
TEST(Verdict, IgnoresEvidenceWithinTheMeshUncertaintyAtTheNoise) {
  Diagnosis diagnosis = SaggingBeam(0, 0);
  diagnosis.nuisances.emplace_back().candidate.card.name = "mesh";
  diagnosis.nuisances.back().candidate.card.is_always_in_model = true;
  diagnosis.nuisances.back().candidate.card.advice = "choose a smaller mesh.max_volume";
  diagnosis.nuisances.back().uncertain_evidence = 200;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous) << "5 σ is not noise";
  EXPECT_THAT(diagnosis.effects, Contains("mesh"));
  diagnosis.baseline_rms_over_sigma = diagnosis.errors.without_nuisances = 1;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAdequate) << Explanation(diagnosis);
  EXPECT_NE(FindReason<UncertainDiscretisation>(diagnosis), nullptr);
  EXPECT_EQ(DescribeNextSteps(RecordOf(diagnosis)),
            "choose a smaller mesh.max_volume, and diagnose again");
}

// With mesh, dimensions and drift at their best for all frames, the residual may be near the noise
// although the fitted frames do not predict the others.
TEST(Verdict, CallsNothingANuisanceThatDoesNotPredict) {
  Diagnosis diagnosis = SaggingBeam(0, 0);
  for (RankedEffect& effect : diagnosis.ranking) effect.evidence = 1;
  ScoredNuisance& drift = diagnosis.nuisances.emplace_back();
  drift.candidate.card.name = "registration_drift";
  drift.evidence = 20;
  drift.explained = 0.1;
  diagnosis.errors.rms_over_sigma = 2.4;
  diagnosis.baseline_rms_over_sigma = 1.18;
  diagnosis.best_rms_over_sigma = 1.15;
  diagnosis.errors.without_nuisances = 1.2;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance) << Explanation(diagnosis);
  diagnosis.effects.clear();
  diagnosis.errors.without_nuisances = 2.4;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary) << Explanation(diagnosis);
  EXPECT_TRUE(diagnosis.effects.empty());
  diagnosis.nuisances.back().explained = 0.7;  // the most of what is left over all frames
  diagnosis.best_rms_over_sigma = 1.3;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary) << Explanation(diagnosis);
  EXPECT_TRUE(diagnosis.effects.empty());
  // Errors of single frames cannot be predicted from others.
  diagnosis.effects.clear();
  diagnosis.nuisances.back().candidate.card.acts_on_single_frames = true;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance) << Explanation(diagnosis);
}

// Both are judged by their refits where there are any: first order overrates both.
TEST(Verdict, ComparesANuisanceWithTheEffectAfterARefit) {
  const auto with = [](std::optional<double> refitted) {
    Diagnosis diagnosis = SaggingBeam(1, 1);
    RankedEffect& force = diagnosis.ranking.front();
    force.evidence = 1900;
    force.scored.score.evidence = 2000;
    ScoredNuisance& drift = diagnosis.nuisances.emplace_back();
    drift.candidate.card.name = "registration_drift";
    drift.evidence = 1980;
    drift.refitted = refitted;
    Decide(&diagnosis);
    return diagnosis;
  };
  EXPECT_THAT(with(1850).effects, ElementsAre("point_force"));
  EXPECT_THAT(with(1899).effects, ElementsAre("point_force", "registration_drift"));
  EXPECT_THAT(with(std::nullopt).effects, ElementsAre("point_force", "registration_drift"));
  // The effect comes first, since it can be added; that the nuisance explains more is a reason.
  EXPECT_THAT(with(1950).effects, ElementsAre("point_force", "registration_drift"));
  EXPECT_THAT(Explanation(with(1950)), HasSubstr("registration_drift has more evidence, e^1950"));
  EXPECT_EQ(FindReason<NuisanceHasMoreEvidence>(with(1899)), nullptr);
}

// A grip that is certainly misplaced, by very little.
TEST(Verdict, MentionsASmallNuisanceAtTheNoiseWithoutNamingIt) {
  Diagnosis diagnosis = SaggingBeam(1, 1);
  for (RankedEffect& effect : diagnosis.ranking) effect.refitted = false;
  diagnosis.baseline_rms_over_sigma = 0.9;
  diagnosis.errors.rms_over_sigma = diagnosis.errors.without_nuisances = 1.1;
  ScoredNuisance& placement = diagnosis.nuisances.emplace_back();
  placement.candidate.card.name = "grip_placement";
  placement.candidate.what = "the placement";
  placement.evidence = 40;
  placement.explained = 0.03;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAdequate) << Explanation(diagnosis);
  EXPECT_NE(FindReason<NuisanceIsNegligible>(diagnosis), nullptr);
  EXPECT_THAT(Explanation(diagnosis), HasSubstr("the placement"));

  diagnosis.effects.clear();
  diagnosis.nuisances.front().explained = 0.3;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance) << Explanation(diagnosis);
  EXPECT_THAT(diagnosis.effects, ElementsAre("grip_placement"));
}

TEST(Verdict, NamesAnEffectThatPredictsBesideTheNuisanceThatExplainsAsMuch) {
  Diagnosis diagnosis = DelayedFrames(0.9 * kEvidence, 3);
  diagnosis.alternatives.effects.front().scored.look_alikes = {"drag"};  // which was not tried
  DecideAgainstNuisances(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(diagnosis.effects, ElementsAre("mass_damping", "drag", "time_jitter"));
  EXPECT_THAT(DescribeNextSteps(RecordOf(diagnosis)), HasSubstr("check the camera's clock"));
}

TEST(Verdict, KeepsTheNuisanceWhereTheEffectExplainsMuchLess) {
  Diagnosis diagnosis = DelayedFrames(0.5 * kEvidence, 3);
  DecideAgainstNuisances(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance);
  EXPECT_THAT(diagnosis.effects, ElementsAre("time_jitter"));
}

TEST(Verdict, KeepsTheNuisanceWhereTheEffectPredictsNothing) {
  Diagnosis diagnosis = DelayedFrames(0.9 * kEvidence, 9.8);
  DecideAgainstNuisances(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance);
}

TEST(Verdict, KeepsTheNuisanceWhereTheEffectCannotBeFitted) {
  Diagnosis diagnosis = DelayedFrames(0.9 * kEvidence, 3);
  diagnosis.alternatives.effects.front().refit_message = "no step could be taken";
  DecideAgainstNuisances(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance);
}

}  // namespace
}  // namespace lacuna
