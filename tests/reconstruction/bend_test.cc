// The demo's experiment on every fifth frame of the bundled recording.
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <utility>

#include "reconstruction/reconstruction.h"
#include "reconstruction/reconstruction_study.h"
#include "support/replace_in_file.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The demo with other frames and another output folder.
std::filesystem::path WriteReducedBend(const TemporaryFolder& folder) {
  const std::filesystem::path experiments =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments";
  const std::string text = WithReplacements(
      FileContent(experiments / "bend.yaml"),
      {{"recording: recordings/bend", "recording: " + (experiments / "recordings/bend").string()},
       {"true_surfaces: recordings/bend/truth",
        "true_surfaces: " + (experiments / "recordings/bend/truth").string()},
       {"output: ../results/bend", "output: " + (folder / "run").string()},
       {"{every: 1}", "{every: 5}"}});
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
  const std::filesystem::path results = folder / "run/results";
  for (const char* file : {"body.pvd", "surface.pvd", "scan.pvd"})
    EXPECT_TRUE(std::filesystem::exists(results / file)) << file;
  for (const auto& [file, field] : {std::pair{"body_0000.vtu", "displacement_m"},
                                    {"body_0000.vtu", "force_N"},
                                    {"body_0000.vtu", "pseudo_force_N"},
                                    {"surface_0000.vtp", "residual_m"},
                                    {"surface_0000.vtp", "residual_length_m"},
                                    {"scan_0000.vtp", "distance_to_model_m"}})
    EXPECT_NE(FileContent(results / "fields" / file).find('"' + std::string(field) + '"'),
              std::string::npos)
        << field;
}

}  // namespace
}  // namespace lacuna
