#include "diagnosis/step_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "calibration/calibration_fits.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/rank_effects.h"
#include "diagnosis/thresholds.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(ShortenStep, HalvesTheStepUntilItsErrorCouldNotBeTakenForAnEffect) {
  const TemporaryFolder folder;
  HeldBarTruth truth;
  truth.alpha = 12;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study =
      ReadBarStudy(folder.Path(), {{"time_step: 1.5 ms", "time_step: 5 ms"}});
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
  SilentProgress progress;
  const Eigen::VectorXd fitted = FitFromStart(problem, &progress).parameters;
  EffectRanking ranking = RankEffects(problem, fitted, &progress);
  ASSERT_GT(ranking.effects.front().score.evidence, kThresholds.refit.least_evidence);

  const std::optional<ShorterStep> shorter = ShortenStep(problem, fitted, ranking, &progress);
  ASSERT_TRUE(shorter);
  EXPECT_LT(shorter->study->time_step, study.time_step);
  EXPECT_EQ(shorter->values.size(), fitted.size());
  const double tolerated = std::max(kThresholds.refit.uncertain_step_evidence,
                                    kToleratedModelError * ranking.effects.front().score.evidence);
  const EffectRanking of_shorter = RankEffects(*shorter->problem, shorter->values, &progress);
  for (const ScoredNuisance& nuisance : of_shorter.nuisances)
    if (nuisance.candidate.card.shrinks_with_time_step)
      EXPECT_LE(nuisance.uncertain_evidence, tolerated);

  // Without evidence for an effect, nothing could be taken for one.
  for (ScoredEffect& effect : ranking.effects) effect.score.evidence = 0;
  EXPECT_FALSE(ShortenStep(problem, fitted, ranking, &progress));
}

}  // namespace
}  // namespace lacuna
