// A model that can be simulated over the fitted frames and not over those that are held out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "calibration/calibration_run.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(StoppedPrediction, SaysThatTheErrorsCoverAPartOfTheFrames) {
  const TemporaryFolder folder;
  WriteBarRecording(folder.Path(), FilmHeldBar({}));
  // A force that no mesh withstands begins behind the fitted frames.
  PredictionStudy study = ReadBarStudy(
      folder.Path(),
      {{"  - {type: mass_damping, alpha: 1 1/s}",
        "  - {type: mass_damping, alpha: 1 1/s}\n"
        "  - {type: point_force, force: [-1e9 N, 1e9 N, 0 N], centre: [0.06 m, 0 m, 0 m], "
        "radius: 10 mm, start: 0.2 s, stop: 0.3 s}"},
       {"{name: young_modulus}, {name: mass_damping.alpha}", ""}});
  study.output = folder / "run";
  SilentProgress progress;
  const CalibrationRecord record = RunCalibration(study, &progress);
  EXPECT_TRUE(record.usable) << record.message;
  ASSERT_EQ(record.recordings.size(), 1u);
  const int frames = record.recordings[0].in_fit.frames + record.recordings[0].held_out.frames;
  EXPECT_LT(frames, kFrames);
  EXPECT_GT(frames, kFrames / 2);
  EXPECT_THAT(record.notes, testing::Contains(testing::AllOf(
                                testing::StartsWith("bar: the simulation stops"),
                                testing::HasSubstr(std::to_string(frames) + " of its 26 frames"))));
}

}  // namespace
}  // namespace lacuna
