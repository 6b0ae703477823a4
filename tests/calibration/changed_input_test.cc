// A recording that changes between the reading of the study and its fit.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "calibration/calibration_run.h"
#include "core/error.h"
#include "support/held_bar.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

void WriteMovingBar(const std::filesystem::path& folder) {
  Eigen::Matrix3Xd moved = BarMarkerPlaces();
  moved.row(1).array() += 0.003;
  std::vector<Eigen::Matrix3Xd> frames(kFrames, BarMarkerPlaces());
  frames[kFrames / 3] = moved;
  WriteBarRecording(folder, frames);
}

// Appends to the file of this name in the folder, which the study was read from, and expects that
// the study is then refused.
void ExpectRefusedAfterAChange(PredictionStudy study, const TemporaryFolder& folder,
                               const std::string& name) {
  study.output = folder / "run";
  std::ofstream(folder / name, std::ios::app) << "\n";
  SilentProgress progress;
  EXPECT_THAT([&] { RunCalibration(study, &progress); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(testing::HasSubstr(name), testing::HasSubstr("has changed"))));
  EXPECT_FALSE(std::filesystem::exists(folder / "run/manifest.json"));
}

TEST(ChangedInput, IsNotFittedUnderTheHashOfItsNewContent) {
  const TemporaryFolder folder;
  WriteMovingBar(folder.Path());
  ExpectRefusedAfterAChange(ReadBarStudy(folder.Path()), folder, "markers.csv");
}

// The experiment names the file, not the recording.
TEST(ChangedInput, TheNodesOfAHoldAreAnInput) {
  const TemporaryFolder folder;
  WriteMovingBar(folder.Path());
  std::ofstream(folder / "held_nodes.txt") << "1\n3\n";
  const PredictionStudy study =
      ReadBarStudy(folder.Path(), {{"{half_space: {point: [0.078 m, 0 m, 0 m], normal: [1, 0, 0]}}",
                                    "{nodes_file: held_nodes.txt}"}});
  ExpectRefusedAfterAChange(study, folder, "held_nodes.txt");
}

}  // namespace
}  // namespace lacuna
