#include "diagnosis/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "effects/catalogue.h"

namespace lacuna {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Not;
using Verdict = Diagnosis::Verdict;

constexpr double kEvidence = 1000;  // of the nuisance

// A time error of every frame explains it all; mass damping, without that, has `evidence` and
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
  diagnosis.instead.nuisances_evidence = kEvidence;
  diagnosis.instead.bare.without_nuisances = 10;
  RankedEffect& damping = diagnosis.instead.effects.emplace_back();
  damping.scored.candidate.type = "mass_damping";
  damping.scored.candidate.effect = MakeEffect("mass_damping", {{"alpha", 10}});
  damping.refitted = true;
  damping.evidence = evidence;
  damping.errors.without_nuisances = error;
  return diagnosis;
}

// A point force has twice the evidence of gravity; on a recording that was not fitted they leave
// these errors, σ.
Diagnosis SaggingBeam(double with_point_force, double with_gravity) {
  Diagnosis diagnosis;
  diagnosis.errors.has_held_out = true;
  diagnosis.errors.without_nuisances = diagnosis.present_in_noise = 5;
  diagnosis.left_in_noise = 1;
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
    effect.left_in_noise = effect.errors.without_nuisances = 1;
    effect.errors.unfitted_in_noise = error;
  };
  add("point_force", 300, with_point_force);
  add("gravity", 150, with_gravity);
  return diagnosis;
}

TEST(Verdict, NamesTheEffectWithFarMoreEvidence) {
  Diagnosis diagnosis = SaggingBeam(12, 12);
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << diagnosis.explanation;
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force"));
}

// Where the model is at the noise as it is, an effect of no size is none.
TEST(Verdict, NamesNoEffectWhoseSizeMayBeNone) {
  Diagnosis diagnosis = SaggingBeam(1, 1);
  ParameterEstimate size;
  size.value = 3;
  size.low = -1;
  size.high = 7;
  for (RankedEffect& effect : diagnosis.ranking) effect.sizes.assign(3, size);
  Diagnosis at_noise = diagnosis;
  at_noise.errors.in_noise = at_noise.errors.without_nuisances = at_noise.present_in_noise = 1.1;
  Diagnosis certain = at_noise;
  at_noise.ranking[0].evidence = 9;
  at_noise.ranking[1].evidence = 2;
  Diagnosis sure = at_noise;
  Decide(&at_noise);
  EXPECT_EQ(at_noise.verdict, Verdict::kAdequate) << at_noise.explanation;
  sure.ranking[0].sizes[1].low = 1;
  Decide(&sure);
  EXPECT_EQ(sure.verdict, Verdict::kMissing) << sure.explanation;
  EXPECT_THAT(sure.effects, ElementsAre("point_force"));
  // The interval of what has such evidence means little.
  Decide(&certain);
  EXPECT_EQ(certain.verdict, Verdict::kMissing) << certain.explanation;
  // Far from the noise, evidence counts.
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << diagnosis.explanation;
}

// Held-out frames that it leaves far from the noise are not predicted.
TEST(Verdict, DoesNotNameAnEffectThatPredictsPoorly) {
  Diagnosis diagnosis = SaggingBeam(12, 12);
  diagnosis.errors.without_nuisances = 2;
  diagnosis.ranking[0].errors.without_nuisances = 1.25;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << diagnosis.explanation;
  diagnosis.ranking[0].errors.without_nuisances = 1.6;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary);
  // It took away nearly all of a much larger error.
  diagnosis.errors.without_nuisances = 6;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << diagnosis.explanation;
  // A rival that explains as much predicts.
  diagnosis.errors.without_nuisances = 2;
  diagnosis.ranking[1].evidence = 295;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
}

// Another effect beside it has much of its evidence.
TEST(Verdict, DoesNotNameAnEffectThatLeavesMoreThanChanceForAnother) {
  Diagnosis diagnosis = SaggingBeam(12, 12);
  diagnosis.ranking[0].further = {"drag", 14};
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << "a twentieth of 300 is 15";
  diagnosis.ranking[0].further.evidence = 16;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary);
  EXPECT_THAT(diagnosis.explanation, testing::HasSubstr("beside it those for drag are e^16"));
  // A rival that explains as much leaves nothing.
  diagnosis.effects.clear();
  diagnosis.ranking[1].evidence = 295;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force", "gravity"));
  diagnosis.effects.clear();
  diagnosis.ranking[1].further = {"drag", 40};
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary);
  // Nor is it another effect where a nuisance explains as much.
  diagnosis.effects.clear();
  diagnosis.ranking[1].evidence = 150;
  diagnosis.ranking[0].further.of_nuisance = 15;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << diagnosis.explanation;
  diagnosis.ranking[0].further.of_nuisance = 0;
  // What the mesh may lend is no evidence.
  diagnosis.nuisances.emplace_back().doubt = 20;
  diagnosis.ranking[1].evidence = 150;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << diagnosis.explanation;
}

// What the held-out frames speak against is not named first, and may still be a rival.
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

// An effect that is not there would do no harm: a refit that says it does has gone astray.
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
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << diagnosis.explanation;
}

TEST(Verdict, DoesNotRuleOutWhatPredictsOtherRecordingsBetter) {
  Diagnosis as_good = SaggingBeam(12, 11.99);
  Decide(&as_good);
  EXPECT_EQ(as_good.verdict, Verdict::kMissing);
  Diagnosis diagnosis = SaggingBeam(12, 11);
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(diagnosis.effects, ElementsAre("point_force", "gravity"));
  EXPECT_NE(diagnosis.explanation.find("11.0 σ against 12.0 σ"), std::string::npos)
      << diagnosis.explanation;
}

// What a finer mesh might change could be what the effect explains.
TEST(Verdict, TakesWhatTheMeshMayLendForNoEvidenceAtTheNoise) {
  Diagnosis diagnosis = SaggingBeam(0, 0);
  diagnosis.nuisances.emplace_back().candidate.card.name = "mesh";
  diagnosis.nuisances.back().candidate.card.is_always_in_model = true;
  diagnosis.nuisances.back().candidate.card.advice = "choose a smaller mesh.max_volume";
  diagnosis.nuisances.back().doubt = 200;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous) << "5 σ are no noise";
  EXPECT_THAT(diagnosis.effects, Contains("mesh"));
  diagnosis.present_in_noise = diagnosis.errors.without_nuisances = 1;
  diagnosis.effects.clear();
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAdequate) << diagnosis.explanation;
  EXPECT_EQ(diagnosis.experiment, "choose a smaller mesh.max_volume, and diagnose again");
}

// With mesh, dimensions and drift at their best for all frames a magnet left 1.2 σ; from the fitted
// frames, 2.4 σ of the others.
TEST(Verdict, CallsNothingANuisanceThatDoesNotPredict) {
  Diagnosis diagnosis = SaggingBeam(0, 0);
  for (RankedEffect& effect : diagnosis.ranking) effect.evidence = 1;
  ScoredNuisance& drift = diagnosis.nuisances.emplace_back();
  drift.candidate.card.name = "registration_drift";
  drift.evidence = 20;
  drift.explained = 0.1;
  diagnosis.errors.in_noise = 2.4;
  diagnosis.present_in_noise = 1.18;
  diagnosis.left_in_noise = 1.15;
  diagnosis.errors.without_nuisances = 1.2;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance) << diagnosis.explanation;
  diagnosis.effects.clear();
  diagnosis.errors.without_nuisances = 2.4;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary) << diagnosis.explanation;
  EXPECT_TRUE(diagnosis.effects.empty());
  diagnosis.nuisances.back().explained = 0.7;  // the most of what is left over all frames
  diagnosis.left_in_noise = 1.3;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNotInLibrary) << diagnosis.explanation;
  EXPECT_TRUE(diagnosis.effects.empty());
  // What is wrong with single frames cannot be predicted.
  diagnosis.effects.clear();
  diagnosis.nuisances.back().candidate.card.acts_on_single_frames = true;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance) << diagnosis.explanation;
}

// Both are judged after a refit where there was one: first order promised both too much.
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
  // An effect comes first, as it can be added; that another does more is said.
  EXPECT_THAT(with(1950).effects, ElementsAre("point_force", "registration_drift"));
  EXPECT_THAT(with(1950).explanation, HasSubstr("registration_drift has more evidence, e^1950"));
  EXPECT_THAT(with(1899).explanation, Not(HasSubstr("more evidence")));
}

// A grip that is certainly misplaced, by a twentieth of a millimetre.
TEST(Verdict, TellsASmallNuisanceAtTheNoiseWithoutNamingIt) {
  Diagnosis diagnosis = SaggingBeam(1, 1);
  for (RankedEffect& effect : diagnosis.ranking) effect.refitted = false;
  diagnosis.present_in_noise = 0.9;
  diagnosis.errors.in_noise = diagnosis.errors.without_nuisances = 1.1;
  ScoredNuisance& placement = diagnosis.nuisances.emplace_back();
  placement.candidate.card.name = "grip_placement";
  placement.candidate.what = "the placement";
  placement.evidence = 40;
  placement.explained = 0.03;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAdequate) << diagnosis.explanation;
  EXPECT_NE(diagnosis.explanation.find("the placement"), std::string::npos);

  diagnosis.effects.clear();
  diagnosis.nuisances.front().explained = 0.3;
  Decide(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance) << diagnosis.explanation;
  EXPECT_THAT(diagnosis.effects, ElementsAre("grip_placement"));
}

TEST(Verdict, SetsAnEffectThatPredictsBesideTheNuisanceThatExplainsAsMuch) {
  Diagnosis diagnosis = DelayedFrames(0.9 * kEvidence, 3);
  diagnosis.instead.effects.front().scored.look_alikes = {"drag"};  // which was not tried
  DecideAgainstNuisances(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kAmbiguous);
  EXPECT_THAT(diagnosis.effects, ElementsAre("mass_damping", "drag", "time_jitter"));
  EXPECT_NE(diagnosis.experiment.find("check the camera's clock"), std::string::npos);
}

TEST(Verdict, LeavesTheNuisanceWhereTheEffectExplainsMuchLess) {
  Diagnosis diagnosis = DelayedFrames(0.5 * kEvidence, 3);
  DecideAgainstNuisances(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance);
  EXPECT_THAT(diagnosis.effects, ElementsAre("time_jitter"));
}

TEST(Verdict, LeavesTheNuisanceWhereTheEffectPredictsNothing) {
  Diagnosis diagnosis = DelayedFrames(0.9 * kEvidence, 9.8);
  DecideAgainstNuisances(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance);
}

TEST(Verdict, LeavesTheNuisanceWhereTheEffectCannotBeFitted) {
  Diagnosis diagnosis = DelayedFrames(0.9 * kEvidence, 3);
  diagnosis.instead.effects.front().refit_message = "no step could be taken";
  DecideAgainstNuisances(&diagnosis);
  EXPECT_EQ(diagnosis.verdict, Verdict::kNuisance);
}

}  // namespace
}  // namespace lacuna
