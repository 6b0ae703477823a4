#include "diagnosis/step_refinement.h"

#include <gtest/gtest.h>

#include <cmath>

#include "calibration/calibration_fits.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/rank_effects.h"
#include "diagnosis/thresholds.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

double UnknownOfStep(const EffectRanking& ranking) {
  for (const ScoredNuisance& nuisance : ranking.nuisances)
    if (nuisance.candidate.card.shrinks_with_time_step) return nuisance.uncertain_evidence;
  return std::nan("");
}

TEST(ShortenStep, HalvesAStepWhoseErrorCouldBeTakenForAnEffect) {
  const TemporaryFolder folder;
  HeldBarTruth truth;
  truth.alpha = 12;
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study =
      ReadBarStudy(folder.Path(), {{"time_step: 1.5 ms", "time_step: 5 ms"},
                                   {"  - {type: mass_damping, alpha: 1 1/s}\n", ""},
                                   {", {name: mass_damping.alpha}", ""}});
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
  SilentProgress progress;
  const Eigen::VectorXd fitted = FitFromStart(problem, &progress).parameters;
  EffectRanking ranking = RankEffects(problem, fitted, &progress);
  // A small effect, and a mesh without an unknown error.
  ranking.effects.front().score.evidence = 10 * kThresholds.refit.least_evidence;
  for (ScoredNuisance& nuisance : ranking.nuisances)
    if (!nuisance.candidate.card.shrinks_with_time_step) nuisance.uncertain_evidence = 0;
  ASSERT_GT(UnknownOfStep(ranking), kThresholds.refit.uncertain_step_evidence);

  const std::optional<ShorterStep> shorter = ShortenStep(problem, fitted, ranking, &progress);
  ASSERT_TRUE(shorter);
  EXPECT_LT(shorter->study->time_step, study.time_step);
  EXPECT_EQ(shorter->values.size(), fitted.size());
  const EffectRanking of_shorter = RankEffects(*shorter->problem, shorter->values, &progress);
  EXPECT_LT(UnknownOfStep(of_shorter), 0.5 * UnknownOfStep(ranking));

  // What is unknown is nothing beside a much larger effect.
  EffectRanking of_large = ranking;
  of_large.effects.front().score.evidence = 2 * UnknownOfStep(ranking) / kToleratedModelError;
  EXPECT_FALSE(ShortenStep(problem, fitted, of_large, &progress));
  // Without evidence for an effect, nothing could be taken for one.
  for (ScoredEffect& effect : ranking.effects) effect.score.evidence = 0;
  EXPECT_FALSE(ShortenStep(problem, fitted, ranking, &progress));
}

}  // namespace
}  // namespace lacuna
