#include "diagnosis/rank_effects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "calibration/calibration_fits.h"
#include "diagnosis/thresholds.h"
#include "effects/catalogue.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// Softer across is, to first order, much like stiffer along; a refit tries both.
TEST(RankEffects, TellsOfOtherDirectionsThatAreAsGood) {
  const TemporaryFolder folder;
  HeldBarTruth truth;
  truth.hidden = {
      MakeEffect("fibre_stiffness", {{"modulus", 5e4}, {"azimuth", 0.6}, {"inclination", 0}})};
  WriteBarRecording(folder.Path(), FilmHeldBar(truth));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({7, 1, 1}, 2));
  SilentProgress progress;
  const Calibration calibration = FitFromStart(problem, &progress);
  const EffectRanking ranking = RankEffects(problem, calibration.parameters, &progress);
  const auto fibres = std::find_if(
      ranking.effects.begin(), ranking.effects.end(),
      [](const ScoredEffect& effect) { return effect.candidate.type == "fibre_stiffness"; });
  ASSERT_NE(fibres, ranking.effects.end());
  ASSERT_FALSE(fibres->elsewhere.empty());
  const auto is_other = [&](const ScoredVariant& other) {
    return std::abs(other.candidate.position.axis.dot(fibres->candidate.position.axis)) < 0.55 &&
           other.score.evidence < fibres->score.evidence;
  };
  EXPECT_TRUE(std::all_of(fibres->elsewhere.begin(), fibres->elsewhere.end(), is_other));
  EXPECT_GT(fibres->elsewhere.front().score.evidence, 0.3 * fibres->score.evidence);
  EXPECT_LT(fibres->elsewhere.front().score.size[0] * fibres->score.size[0], 0);
}

TEST(RankEffects, TakesOverTheColumnsOfItsScene) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
  SilentProgress progress;
  const EffectRanking first = RankEffects(problem, problem.Start(), &progress);
  ASSERT_TRUE(first.scene.pilots.has_value());
  const auto shape = [](const auto& nuisances) {
    return std::find_if(nuisances.begin(), nuisances.end(),
                        [](const auto& own) { return own.card.name == "shape"; });
  };
  ASSERT_NE(shape(first.scene.nuisances), first.scene.nuisances.end());
  EXPECT_TRUE(std::all_of(first.scene.nuisances.begin(), first.scene.nuisances.end(),
                          [](const auto& own) { return own.card.is_shared_in_scene; }));
  SceneColumns known = first.scene;
  for (NuisanceCandidate& own : known.nuisances) own.columns *= 2;
  for (PilotHypothesis& pilot : known.pilots->tried) pilot.change *= 2;
  const EffectRanking second = RankEffects(problem, problem.Start(), &progress, {}, known);
  EXPECT_EQ(shape(second.scene.nuisances)->columns, 2 * shape(first.scene.nuisances)->columns);
  ASSERT_EQ(second.scene.pilots->tried.size(), first.scene.pilots->tried.size());
  for (size_t k = 0; k < first.scene.pilots->tried.size(); ++k)
    EXPECT_EQ(second.scene.pilots->tried[k].change, 2 * first.scene.pilots->tried[k].change);
}

// The bar stands still after its film, so that the recording becomes too long for a nuisance that
// needs a column for each frame.
TEST(RankEffects, NamesTheRecordingsWithTooManyFramesForANuisance) {
  const TemporaryFolder folder;
  std::vector<Eigen::Matrix3Xd> markers = FilmHeldBar({});
  markers.resize(kThresholds.nuisances.most_single_frames + 1, markers.back());
  WriteBarRecording(folder.Path(), markers);
  const PredictionStudy study =
      ReadBarStudy(folder.Path(), {{"time_step: 1.5 ms", "time_step: 5 ms"}});
  const CalibrationProblem problem(study, BarMesh({3, 1, 1}, 1));
  SilentProgress progress;
  const EffectRanking ranking = RankEffects(problem, problem.Start(), &progress);
  const auto untried =
      std::find_if(ranking.untried.begin(), ranking.untried.end(),
                   [](const UntriedEffect& one) { return one.type == "time_jitter"; });
  ASSERT_NE(untried, ranking.untried.end());
  EXPECT_EQ(untried->why, "bar has more than 400 frames: thin them out with `every`");
  EXPECT_TRUE(std::none_of(
      ranking.nuisances.begin(), ranking.nuisances.end(),
      [](const ScoredNuisance& one) { return one.candidate.card.name == "time_jitter"; }));
}

// What an added effect has explained tells how large the error of its own model may be.
TEST(RankEffects, CountsTheErrorOfEffectsThatWereAddedBefore) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  PredictionStudy study = ReadBarStudy(folder.Path());
  SilentProgress progress;
  const auto rank = [&](const SceneColumns& known) {
    const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 1));
    return RankEffects(problem, problem.Start(), &progress, {}, known);
  };
  const EffectRanking first = rank({});
  study.explained_misfit = 10'000;
  const EffectRanking later = rank(first.scene);
  EXPECT_NEAR(later.ModelError() - first.ModelError(), 0.5 * 0.01 * 10'000, 1e-6);
}

// A nuisance that an earlier ranking has adopted along another motion, and one that cannot be made
// along this one.
TEST(RankEffects, TakesTheColumnsOfAdoptedNuisancesAlongItsOwnMotion) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  const PredictionStudy study = ReadBarStudy(folder.Path());
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 1));
  SilentProgress progress;
  const EffectRanking first = RankEffects(problem, problem.Start(), &progress);
  EffectRanking decided = first;
  for (ScoredNuisance& nuisance : decided.nuisances)
    nuisance.adopted = nuisance.candidate.card.is_always_in_model;
  const auto found = std::find_if(
      decided.nuisances.begin(), decided.nuisances.end(),
      [](const ScoredNuisance& one) { return one.candidate.card.name == "grip_placement"; });
  ASSERT_NE(found, decided.nuisances.end());
  const Eigen::MatrixXd along = found->candidate.columns;
  found->candidate.columns *= 2;
  found->adopted = true;
  ScoredNuisance gone = *found;
  gone.candidate.what = "a grip that is gone";
  decided.nuisances.push_back(gone);
  const DecidedBase base{decided, first.noise};
  const AdoptedNuisances adopted =
      RankEffects(problem, problem.Start(), &progress, {}, first.scene, &base).adopted;
  ASSERT_EQ(adopted.always, first.adopted.always);
  const Eigen::Index width = along.cols();
  ASSERT_EQ(adopted.columns.cols(), adopted.always + 2 * width);
  EXPECT_EQ(adopted.columns.leftCols(adopted.always),
            first.adopted.columns.leftCols(adopted.always));
  EXPECT_EQ(adopted.columns.middleCols(adopted.always, width), along);
  EXPECT_EQ(adopted.columns.rightCols(width), 2 * along);
}

}  // namespace
}  // namespace lacuna
