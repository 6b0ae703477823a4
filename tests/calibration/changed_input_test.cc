// A recording that changes between the reading of the study and its fit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "calibration/calibration_run.h"
#include "core/error.h"
#include "support/held_bar.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

TEST(ChangedInput, IsNotFittedUnderTheHashOfItsNewContent) {
  const TemporaryFolder folder;
  Eigen::Matrix3Xd moved = BarMarkerPlaces();
  moved.row(1).array() += 0.003;
  std::vector<Eigen::Matrix3Xd> frames(kFrames, BarMarkerPlaces());
  frames[kFrames / 3] = moved;
  WriteBarRecording(folder.Path(), frames);
  PredictionStudy study = ReadBarStudy(folder.Path());
  study.output = folder / "run";
  std::ofstream(folder / "markers.csv", std::ios::app) << "\n";
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  Progress progress(silent);
  EXPECT_THAT([&] { RunCalibration(study, &progress); },
              testing::ThrowsMessage<InputError>(testing::AllOf(
                  testing::HasSubstr("markers.csv"), testing::HasSubstr("has changed"))));
  EXPECT_FALSE(std::filesystem::exists(folder / "run/manifest.json"));
}

}  // namespace
}  // namespace lacuna
