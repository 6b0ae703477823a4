#include "diagnosis/loaded_bar.h"

#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>

#include "calibration/adaptive_time_step.h"
#include "diagnosis/rank_effects.h"
#include "diagnosis/recorded_diagnosis.h"
#include "effects/catalogue.h"
#include "report/verdict_text.h"
#include "support/held_bar.h"

namespace lacuna {
namespace {

// First order alone finds the side and about the place.
TEST_F(LoadedBar, TriesASupportOnEachSide) {
  PredictionStudy study = Record({BedBelow()});
  const TetMesh mesh = BarMesh({7, 1, 1}, 2);
  const AdaptedFit fit = FitWithAdaptiveTimeStep(mesh, &study, &progress_);
  ASSERT_TRUE(fit.calibration.usable) << fit.calibration.message;
  const CalibrationProblem problem(study, mesh);
  const EffectRanking ranking =
      RankEffects(problem, fit.calibration.parameters, &progress_, {}, {});
  const auto support = std::find_if(
      ranking.effects.begin(), ranking.effects.end(),
      [](const ScoredEffect& effect) { return effect.candidate.type == "elastic_support"; });
  ASSERT_NE(support, ranking.effects.end());
  EXPECT_THAT(support->candidate.variant, testing::StartsWith("on the −z side"));
  EXPECT_GT(support->score.evidence, 20);
}

// Eight states of one bar tell nearly as much in recordings of one frame each as in one recording,
// because the markers stay where they are on the bar. (Each recording has nuisances of its own.)
// Markers that were put on anew have other names, and errors of their own, which hide the bed where
// the places are known to 1 mm only.
TEST_F(LoadedBar, TellsMoreWhereRecordingsShareMarkers) {
  PredictionStudy together = Record({BedBelow()});
  together.place_deviation = 1e-3;
  together.recordings.front().fit_until = 20;
  together.recordings.front().frames = {1, 3, 5, 7, 9, 11, 13, 15};
  PredictionStudy apart = together;
  apart.recordings.clear();
  for (const int frame : together.recordings.front().frames) {
    PredictedRecording& one = apart.recordings.emplace_back(together.recordings.front());
    one.frames = {frame};
    one.name = fmt::format("frame {}", frame);
  }
  PredictionStudy renamed = apart;
  for (PredictedRecording& one : renamed.recordings)
    for (std::string& marker : one.recording.markers.names) marker += " in " + one.name;
  const TetMesh mesh = BarMesh({7, 1, 1}, 2);
  const auto evidence = [&](PredictionStudy* study) {
    const AdaptedFit fit = FitWithAdaptiveTimeStep(mesh, study, &progress_);
    EXPECT_TRUE(fit.calibration.usable) << fit.calibration.message;
    const CalibrationProblem problem(*study, mesh);
    return RankEffects(problem, fit.calibration.parameters, &progress_, {}, {})
        .Find("elastic_support")
        ->score.evidence;
  };
  const double in_one = evidence(&together);
  EXPECT_GT(in_one, 30);
  EXPECT_GT(evidence(&apart), 0.6 * in_one);
  EXPECT_LT(evidence(&renamed), 0.3 * in_one);
}

TEST_F(LoadedBar, TellsThatItCreeps) {
  PredictionStudy study =
      Record({MakeEffect("viscoelastic_branch",
                         {{"modulus", 4e4}, {"relaxation_time", 2.5}, {"poisson_ratio", kRatio}})});
  const Diagnosis diagnosis = FitAndDiagnose(&study);
  EXPECT_EQ(diagnosis.verdict, Verdict::kMissing) << ExplainVerdict(RecordOf(diagnosis));
  EXPECT_THAT(diagnosis.effects, testing::ElementsAre("viscoelastic_branch"));
  for (const RankedEffect& effect : diagnosis.ranking) {
    if (effect.scored.candidate.type != "viscoelastic_branch") continue;
    ASSERT_EQ(effect.others.size(), 1u);
    EXPECT_EQ(effect.others[0].name, "viscoelastic_branch.relaxation_time");
    EXPECT_EQ(effect.others[0].unit, "s");
    EXPECT_NEAR(effect.others[0].estimate.value, 2.5, 0.5);
    EXPECT_NEAR(effect.sizes.at(0).value, 4e4, 0.6e4);
  }
}

// The cameras were set up anew in the middle of the experiment.
TEST_F(LoadedBar, StandsElsewhereInAnotherRecording) {
  PredictionStudy study = Record({});
  PredictedRecording& first = study.recordings.front();
  PredictedRecording second = first;
  first.name = "before";
  first.frames = {0, 1, 2, 3, 4, 5, 6, 7};
  second.name = "after";
  second.frames = {8, 9, 10, 11, 12, 13, 14, 15};
  second.fit_until = 20;
  for (Eigen::Matrix3Xd& markers : second.recording.markers.positions)
    markers.colwise() += Eigen::Vector3d(6e-4, -4e-4, 5e-4);
  study.recordings.push_back(second);
  const Diagnosis diagnosis = FitAndDiagnose(&study);
  EXPECT_THAT(diagnosis.effects, testing::Contains("registration"))
      << ExplainVerdict(RecordOf(diagnosis));
}

// The bar bends so far that the response to its load is not linear. To first order a wrong load
// explains less than it does, and an effect that is fitted would be taken for it.
TEST_F(LoadedBar, BendsAsUnderTheLoadThatItReallyBears) {
  PredictionStudy study = Record({}, "", "", /*reading=*/1.4);
  const Diagnosis diagnosis = FitAndDiagnose(&study);
  EXPECT_THAT(diagnosis.effects, testing::Contains("load_scale"))
      << ExplainVerdict(RecordOf(diagnosis));
  const auto scale = std::find_if(
      diagnosis.nuisances.begin(), diagnosis.nuisances.end(),
      [](const ScoredNuisance& nuisance) { return nuisance.candidate.card.name == "load_scale"; });
  ASSERT_NE(scale, diagnosis.nuisances.end());
  ASSERT_TRUE(scale->refitted.has_value());
  EXPECT_GT(*scale->refitted, scale->evidence + 2);
  for (const RankedEffect& effect : diagnosis.ranking)
    EXPECT_GT(*scale->refitted, effect.evidence) << effect.scored.candidate.type;
}

}  // namespace
}  // namespace lacuna
