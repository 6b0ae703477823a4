// The columns of candidate effects have the rows of measured forces: an effect that a motion driven
// by grips does not show appears in the force.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "calibration/calibration_fits.h"
#include "diagnosis/diagnosis.h"
#include "diagnosis/rank_effects.h"
#include "diagnosis/recorded_diagnosis.h"
#include "effects/catalogue.h"
#include "report/verdict_text.h"
#include "support/pulled_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// A bar that stiffens with strain, and a fit of the model without it.
struct StiffeningBar {
  explicit StiffeningBar(const std::string& measured_force) {
    PulledBarTruth truth;
    truth.hidden = {MakeEffect("strain_stiffening", {{"modulus", 8e4}})};
    WritePulledBar(folder.Path(), truth, measured_force);
    study = ReadPulledBarStudy(folder.Path());
    problem = std::make_unique<CalibrationProblem>(study, BarMesh({6, 1, 1}, 2));
    values = FitFromStart(*problem, &progress).parameters;
  }

  TemporaryFolder folder;
  PredictionStudy study;
  std::unique_ptr<CalibrationProblem> problem;
  SilentProgress progress;
  Eigen::VectorXd values;
};

double EvidenceForStiffening(StiffeningBar* bar) {
  const EffectRanking ranking = RankEffects(*bar->problem, bar->values, &bar->progress);
  const auto found = std::find_if(
      ranking.effects.begin(), ranking.effects.end(),
      [](const ScoredEffect& effect) { return effect.candidate.type == "strain_stiffening"; });
  EXPECT_NE(found, ranking.effects.end());
  return found != ranking.effects.end() ? found->score.evidence : 0;
}

TEST(MeasuredForceInADiagnosis, ShowsWhatTheMarkersDoNot) {
  StiffeningBar without(""), with(kLoadCell);
  EXPECT_LT(EvidenceForStiffening(&without), 3);
  EXPECT_GT(EvidenceForStiffening(&with), 10);
}

// The look-alikes of the effect are other elasticity laws and effects that stiffen a bar which is
// stretched; nothing else explains the force.
TEST(MeasuredForceInADiagnosis, LeadsToTheEffectThatIsMissing) {
  StiffeningBar bar(kLoadCell);
  const Diagnosis diagnosis = Diagnose(*bar.problem, bar.values, {}, &bar.progress);
  EXPECT_TRUE(diagnosis.verdict == Verdict::kMissing || diagnosis.verdict == Verdict::kAmbiguous)
      << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_THAT(diagnosis.effects, testing::Contains("strain_stiffening"))
      << ExplainVerdict(RecordOf(diagnosis));
  const auto found = std::find_if(diagnosis.ranking.begin(), diagnosis.ranking.end(),
                                  [](const RankedEffect& effect) {
                                    return effect.scored.candidate.type == "strain_stiffening";
                                  });
  ASSERT_NE(found, diagnosis.ranking.end());
  ASSERT_TRUE(found->HasUsableRefit()) << found->refit_message;
  ASSERT_TRUE(found->removed);
  // The evidence is at most half of the squared misfit that is removed, because the variance of the
  // noise is at least the stated one. The markers follow the grips with or without the effect: what
  // they gain or lose is mostly noise.
  EXPECT_GT(found->removed->forces, std::max(1.0, found->evidence));
  EXPECT_LT(std::abs(found->removed->markers), found->removed->forces);
  EXPECT_EQ(found->removed->scans, 0);
}

// A model of which nothing is fitted has no estimates, and the evidence of its hypotheses comes
// from the effects alone.
TEST(DiagnosisWithoutFittedParameters, LeadsToTheEffectThatIsMissing) {
  const TemporaryFolder folder;
  PulledBarTruth truth;
  truth.hidden = {MakeEffect("strain_stiffening", {{"modulus", 8e4}})};
  WritePulledBar(folder.Path(), truth);
  const PredictionStudy study = ReadPulledBarStudy(
      folder.Path(),
      {{"[{name: young_modulus}]", "[]"}, {"young_modulus: 0.15 MPa", "young_modulus: 0.1 MPa"}});
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
  ASSERT_TRUE(problem.parameters().empty());
  SilentProgress progress;
  const Calibration fit = FitFromStart(problem, &progress);
  ASSERT_TRUE(fit.usable) << fit.message;
  const Diagnosis diagnosis =
      Diagnose(problem, fit.parameters, {.refits = 1, .without = {}}, &progress);
  EXPECT_TRUE(diagnosis.verdict == Verdict::kMissing || diagnosis.verdict == Verdict::kAmbiguous)
      << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_THAT(diagnosis.effects, testing::Contains("strain_stiffening"));
  EXPECT_GT(diagnosis.noise_level.variance, 0);
}

}  // namespace
}  // namespace lacuna
