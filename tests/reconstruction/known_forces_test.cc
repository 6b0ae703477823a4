// A load cell's reading drives the model: nothing is fitted, everything is predicted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "experiment/scene.h"
#include "reconstruction/reconstruction.h"
#include "reconstruction/reconstruction_study.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

constexpr double kNoise = 3e-4;  // m, of the scanner below

// A quadratic bar that a measured force bends by some 20 mm, scanned.
void WriteLoadedBar(const std::filesystem::path& folder, Progress* progress) {
  const Scene scene = ReadScene(Config::Parse(R"(schema_version: 1
name: loaded_bar
bar: {centre: [50 mm, 15 mm, 15 mm], size: [100 mm, 30 mm, 30 mm], edge_radius: 5 mm, edge_length: 8 mm}
mesh: {max_volume: 200 mm^3, order: 2}
density: 1000 kg/m^3
material: {law: neo_hookean, young_modulus: 0.1 MPa, poisson_ratio: 0.4}
effects: [{type: stiffness_damping, beta: 5 ms}]
grips: [{region: {name: clamp, half_space: {point: [8 mm, 0 mm, 0 mm], normal: [-1, 0, 0]}}}]
loads:
  - region: {name: tip, half_space: {point: [92 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}
    force: [0 N, 0 N, -0.7 N]
    profile: {times: [0 s, 0.3 s], values: [0, 1]}
    measured: true
motion: {frame_rate: 20 Hz, frames: 11, steps_per_frame: 4}
scanner: {look_at: [50 mm, 15 mm, 5 mm], distance: 0.4 m, elevation: 30 deg, width: 96, height: 72,
          field_of_view: 24 deg, noise: 0.3 mm}
)",
                                              "scene.yaml"));
  const SceneMotion motion = SimulateScene(scene, progress);
  ASSERT_TRUE(motion.IsUsable()) << motion.message;
  WriteSceneRecording(scene, motion, folder);
}

std::string Experiment(const TemporaryFolder& folder, const std::string& forces) {
  return "schema_version: 1\nname: known\nrecording: " + (folder / "scan").string() +
         "\noutput: " + (folder / "run").string() + R"(
surface: {edge_length: 6 mm}
mesh: {max_volume: 200 mm^3, order: 2}
material: {law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.4}
effects: [{type: stiffness_damping, beta: 5 ms}]
motion: {scheme: bdf2}
fit: {noise: 0.3 mm}
forces: )" +
         forces + "\nvalidation: {true_surfaces: " + (folder / "scan/truth").string() + "}\n";
}

TEST(KnownForces, PredictTheMotionThatTheyCaused) {
  const TemporaryFolder folder;
  SilentProgress progress;
  WriteLoadedBar(folder / "scan", &progress);
  const ReconstructionStudy study =
      ReadReconstruction(Config::Parse(Experiment(folder, "{model: known}"), "known.yaml"));
  const RunRecord record = RunReconstruction(study, &progress);
  ASSERT_TRUE(record.IsUsable());
  EXPECT_NEAR(record.frames.back().force_resultant.z(), -0.7, 1e-9);
  // The tip moves by 20 mm. What remains is the shape of S_0 in its third power (0.2 mm of 30 mm
  // are 2 % of the stiffness), the coarser step and the other law: below 3 σ.
  EXPECT_LE(record.measures.at("true_surface_distance_max_m"), 3 * kNoise);

  // Without the forces the model stays where it is, and the error is of the size of the motion.
  const RunRecord unloaded = RunReconstruction(
      ReadReconstruction(Config::Parse(Experiment(folder, "{model: none}"), "none.yaml")),
      &progress);
  EXPECT_GE(unloaded.measures.at("true_surface_distance_max_m"), 10 * kNoise);
}

TEST(KnownForces, AreRefusedWhereTheyAreNotKnown) {
  const TemporaryFolder folder;
  const std::filesystem::path bend =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/recordings/bend";
  std::string text = Experiment(folder, "{model: known}");
  const auto replace = [&text](const std::string& from, const std::string& to) {
    ASSERT_NE(text.find(from), std::string::npos) << from;
    text.replace(text.find(from), from.size(), to);
  };
  replace((folder / "scan/truth").string(), (bend / "truth").string());
  replace((folder / "scan").string(), bend.string());
  try {
    ReadReconstruction(Config::Parse(text, "known.yaml"));
    FAIL() << "nothing was refused";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), testing::HasSubstr("the recording has no forces"));
  }
}

}  // namespace
}  // namespace lacuna
