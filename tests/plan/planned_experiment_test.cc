#include "plan/planned_experiment.h"

#include <gtest/gtest.h>

#include <fstream>

#include "plan/planned_bar.h"
#include "prediction/prediction_study_reader.h"

namespace lacuna {
namespace {

// "bar: #2" would be a mapping and a comment without quotes, and the quotes in the name would end
// them.
TEST(PlannedExperiment, IsReadBackWhateverCharactersTheNameOfTheStudyHolds) {
  const PlannedBar bar;
  std::ofstream(bar.folder / "study.yaml") << BarExperiment(bar.folder.Path());
  FittedRun fitted;
  fitted.study = bar.study;
  fitted.study.name = "bar: #2 \"soft\"";
  fitted.study.output = bar.folder / "runs/bar";
  fitted.mesh = bar.mesh;
  fitted.values = CalibrationProblem(fitted.study, fitted.mesh).Start();
  Protocol protocol;
  protocol.name = "again";
  protocol.recording = bar.Name();
  protocol.duration = 0.2;
  const std::filesystem::path folder = bar.folder / "plan";
  WritePlannedExperiment(fitted, 0.01, protocol, folder);

  std::filesystem::copy(folder / "predicted", folder / "measured");
  const PredictionStudy joint = ReadPredictionStudy(Config::Load(folder / "experiment.yaml"));
  EXPECT_EQ(joint.name, "bar: #2 \"soft\"-with-again");
  EXPECT_EQ(std::filesystem::weakly_canonical(joint.output),
            std::filesystem::weakly_canonical(bar.folder / "runs" / joint.name));
  EXPECT_EQ(joint.recordings.size(), 2u);
}

}  // namespace
}  // namespace lacuna
