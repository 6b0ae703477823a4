// The demo's experiment on every fifth frame of the bundled recording.
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "reconstruction/reconstruction.h"
#include "reconstruction/reconstruction_study.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The demo with other frames and another output folder.
std::filesystem::path WriteReducedBend(const TemporaryFolder& folder) {
  const std::filesystem::path experiments =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments";
  std::string text = FileContent(experiments / "bend.yaml");
  const auto replace = [&text](const std::string& from, const std::string& to) {
    const size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    text.replace(at, from.size(), to);
  };
  replace("recording: recordings/bend", "recording: " + (experiments / "recordings/bend").string());
  replace("true_surfaces: recordings/bend/truth",
          "true_surfaces: " + (experiments / "recordings/bend/truth").string());
  replace("output: ../results/bend", "output: " + (folder / "run").string());
  replace("{every: 1}", "{every: 5}");
  std::ofstream(folder / "bend.yaml") << text;
  return folder / "bend.yaml";
}

RunRecord RunExperiment(const std::filesystem::path& experiment) {
  SilentProgress progress;
  return RunReconstruction(ReadReconstruction(Config::Load(experiment)), &progress);
}

TEST(Bend, TheModelFollowsTheScansToTheirNoise) {
  const TemporaryFolder folder;
  const std::filesystem::path experiment = WriteReducedBend(folder);
  const RunRecord record = RunExperiment(experiment);
  ASSERT_TRUE(record.IsUsable());
  ASSERT_EQ(record.frames.size(), 4u);
  const double noise = 3e-4;  // of the virtual scanner, m: experiments/scenes/bend.yaml
  for (const FrameRecord& frame : record.frames) {
    EXPECT_LE(frame.surface_distance_mean, 1.5 * noise) << "frame " << frame.frame;
    if (frame.frame == 0) continue;
    EXPECT_LE(frame.relative_residual, 0.004) << "frame " << frame.frame;
  }
  // Five frames are one step here, so that the last frames are reached in strides of 10 mm.
  EXPECT_LE(record.measures.at("true_surface_distance_max_m"), noise);

  // The same command again reads the stages back and changes nothing.
  const std::string manifest = FileContent(folder / "run" / "manifest.json");
  const RunRecord again = RunExperiment(experiment);
  EXPECT_EQ(FileContent(folder / "run" / "manifest.json"), manifest);
  EXPECT_EQ(again.animation_residual, record.animation_residual);
  EXPECT_TRUE(std::filesystem::exists(folder / "run/results/body.pvd"));
}

}  // namespace
}  // namespace lacuna
