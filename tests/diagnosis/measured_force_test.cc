// The columns of candidate effects have the rows of measured forces: an effect that a motion driven
// by grips does not show appears in the force.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "calibration/calibration_fits.h"
#include "diagnosis/effect_ranking.h"
#include "effects/catalogue.h"
#include "prediction/prediction_study_reader.h"
#include "support/pulled_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The evidence for strain stiffening in a bar that has it.
double EvidenceForStiffening(const std::string& measured_force) {
  const TemporaryFolder folder;
  PulledBarTruth truth;
  truth.hidden = {MakeEffect("strain_stiffening", {{"modulus", 8e4}})};
  WritePulledBar(folder.Path(), truth, measured_force);
  const PredictionStudy study = ReadPredictionStudy(
      Config::Parse(PulledBarExperiment(folder.Path()), (folder / "study.yaml").string()));
  const CalibrationProblem problem(study, BarMesh({6, 1, 1}, 2));
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  Progress progress(silent);
  const Calibration calibration = FitFromStart(problem, &progress);
  const EffectRanking ranking = RankEffects(problem, calibration.parameters, &progress);
  const auto found = std::find_if(
      ranking.effects.begin(), ranking.effects.end(),
      [](const ScoredEffect& effect) { return effect.candidate.type == "strain_stiffening"; });
  EXPECT_NE(found, ranking.effects.end());
  return found != ranking.effects.end() ? found->score.evidence : 0;
}

TEST(MeasuredForceInADiagnosis, ShowsWhatTheMarkersDoNot) {
  const double without = EvidenceForStiffening("");
  const double with = EvidenceForStiffening(kLoadCell);
  EXPECT_LT(without, 3);
  EXPECT_GT(with, 10);
}

}  // namespace
}  // namespace lacuna
