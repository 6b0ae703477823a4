// `lacuna simulate`, and a sweep over reconstructions of what it has recorded.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "app/command_line.h"
#include "scan/recording_writer.h"

namespace lacuna {
namespace {

using testing::HasSubstr;
using testing::Not;

TEST(CommandLine, WhatIsSimulatedIsAnOrdinaryRecording) {
  const TemporaryFolder folder;
  const std::string scan = (folder / "scan").string();
  const std::string simulate = "simulate " + WriteSmallScene(folder) + " -o " +
                               (folder / "run").string() + " --recording " + scan;
  const Ending made = Lacuna(simulate);
  ASSERT_EQ(made.status, 0) << made.said;
  EXPECT_THAT(made.said, Not(HasSubstr("warning")));
  EXPECT_TRUE(std::filesystem::exists(folder / "run/body.pvd"));
  EXPECT_EQ(Lacuna("validate " + scan).status, 0);
  const Ending info = Lacuna("info " + scan);
  EXPECT_EQ(info.status, 0);
  EXPECT_THAT(info.said, HasSubstr("3 point clouds"));
  EXPECT_EQ(Lacuna(simulate).status, 0) << "what was simulated may be simulated again";

  // What an interruption leaves while the recording is written.
  std::ofstream(scan + "/recording.yaml") << "# " << kSimulated << "\n";
  std::filesystem::remove_all(scan + "/truth");
  const Ending again = Lacuna(simulate);
  EXPECT_EQ(again.status, 0) << again.said;
  EXPECT_EQ(Lacuna("validate " + scan).status, 0);
}

// The errors of two synthetic data sets are independent, unless one is a repetition of the other.
TEST(CommandLine, SimulatedExperimentsHaveErrorsOfTheirOwn) {
  const TemporaryFolder folder;
  const auto markers = [&](const std::string& name, const std::string& options) {
    std::ofstream(folder / "e.yaml")
        << "use: " << Experiment("hidden_effect.yaml") << "\nname: " << name
        << "\nnoise: 0.1 mm\n"
           "mesh: {max_volume: 8000 mm^3, order: 2, preserve_surface: false}\n"
           "motion: {time_step: 10 ms}\nrecordings:\n  - {name: pull, recording: "
        << Experiment("recordings/hidden_effect/recording_1")
        << ", to: 0.12 s, hold: {release: 0.1037 s, force: [0 N, 0 N, 0.05 N], region: "
           "{half_space: {point: [71.4274 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}}}\n";
    const Ending ending =
        Lacuna("simulate " + (folder / "e.yaml").string() + " -o " + (folder / "out").string() +
               " --recording " + (folder / "played").string() + options);
    EXPECT_EQ(ending.status, 0) << ending.said;
    return FileContent(folder / "played/markers.csv");
  };
  const std::string first = markers("one", "");
  EXPECT_EQ(markers("one", ""), first);
  EXPECT_NE(markers("two", ""), first);
  EXPECT_NE(markers("one", " --seed 1"), first);
}

// Names that lead upwards: of an experiment, and of the recordings of one.
TEST(CommandLine, WhatIsWrittenStaysInItsFolder) {
  const TemporaryFolder folder;
  std::string text = FileContent(WriteSmallScene(folder));
  text.replace(text.find("name: small"), 11, "name: ../../ESC");
  std::ofstream(folder / "scene.yaml") << text;
  const Ending scene = Lacuna("simulate " + (folder / "scene.yaml").string());
  EXPECT_EQ(scene.status, 2);
  EXPECT_THAT(scene.said, HasSubstr("scene.yaml:2:7: name: names a folder"));

  const auto recording = [](const std::string& name) {
    return "  - {name: \"" + name +
           "\", recording: " + Experiment("recordings/hidden_effect/recording_1") +
           ", to: 0.12 s, hold: {release: 0.1037 s, force: [0 N, 0 N, 0.05 N], region: "
           "{half_space: {point: [71.4274 mm, 0 mm, 0 mm], normal: [1, 0, 0]}}}}\n";
  };
  const std::string begin = "use: " + Experiment("hidden_effect.yaml") +
                            "\nmesh: {max_volume: 8000 mm^3, order: 2, preserve_surface: false}\n"
                            "motion: {time_step: 10 ms}\nrecordings:\n";
  std::filesystem::create_directories(folder / "a");
  std::ofstream(folder / "a/e.yaml") << begin << recording("..") << recording("../../ESC");
  const std::string simulate = "simulate " + (folder / "a/e.yaml").string() + " -o " +
                               (folder / "a/out").string() + " --recording " +
                               (folder / "a/played").string();
  const Ending played = Lacuna(simulate);
  EXPECT_EQ(played.status, 0) << played.said;
  EXPECT_THAT(played.said, HasSubstr("its markers have no errors")) << "noise is not given";
  EXPECT_TRUE(std::filesystem::exists(folder / "a/out/_./body.pvd"));
  EXPECT_TRUE(std::filesystem::exists(folder / "a/played/_._.._ESC/recording.yaml"));
  EXPECT_FALSE(std::filesystem::exists(folder / "a/body.pvd"));
  EXPECT_FALSE(std::filesystem::exists(folder / "ESC"));

  std::ofstream(folder / "a/e.yaml")
      << "material: {law: neo_hookean, young_modulus: 0.12 MPa, poisson_ratio: -0.2}\n"
      << begin << recording("a b") << recording("a/b");
  const Ending same = Lacuna(simulate);
  EXPECT_EQ(same.status, 2);
  EXPECT_THAT(same.said, HasSubstr("warning: neo_hookean.poisson_ratio is -0.2: an auxetic"));
  EXPECT_THAT(same.said, HasSubstr("recording a/b would have the same folder, a_b, as another"));
}

// A negative ratio may be a wrong sign or meant, so that the scene is simulated all the same.
TEST(CommandLine, ANegativePoissonRatioOfASceneCausesAWarning) {
  const TemporaryFolder folder;
  std::string text = FileContent(WriteSmallScene(folder));
  const std::string positive = "poisson_ratio: 0.4";
  text.replace(text.find(positive), positive.size(), "poisson_ratio: -0.3");
  std::ofstream(folder / "scene.yaml") << text;
  const Ending ending =
      Lacuna("simulate " + (folder / "scene.yaml").string() + " -o " + (folder / "run").string());
  EXPECT_EQ(ending.status, 0) << ending.said;
  EXPECT_THAT(ending.said, HasSubstr("warning: corotational.poisson_ratio is -0.3: an auxetic"));
  EXPECT_TRUE(std::filesystem::exists(folder / "run/body.pvd"));
  const Ending validated = Lacuna("validate " + (folder / "scene.yaml").string());
  EXPECT_EQ(validated.status, 0) << validated.said;
  EXPECT_THAT(validated.said, HasSubstr("warning: corotational.poisson_ratio is -0.3: an auxetic"));
}

TEST(CommandLine, AnUnwritableOutputIsToldBeforeTheComputation) {
  const TemporaryFolder folder;
  std::ofstream(folder / "occupied") << "a file";
  const Ending ending =
      Lacuna("simulate " + WriteSmallScene(folder) + " -o " + (folder / "occupied/run").string());
  EXPECT_EQ(ending.status, 2);
  EXPECT_THAT(ending.said, HasSubstr("occupied"));
  EXPECT_THAT(ending.said, Not(HasSubstr("largest displacement")));
}

// A reconstruction of a few frames, in two sizes of its mesh and one that cannot be.
TEST(CommandLine, ASweepIsPlannedRunAndCollected) {
  const TemporaryFolder folder;
  const std::string scan = (folder / "scan").string();
  ASSERT_EQ(Lacuna("simulate " + WriteSmallScene(folder) + " -o " + (folder / "motion").string() +
                   " --recording " + scan)
                .status,
            0);
  std::ofstream(folder / "small.yaml") << R"(schema_version: 1
name: small
recording: scan
surface: {edge_length: 12 mm}
mesh: {max_volume: 2000 mm^3}
material: {law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.4}
forces: {model: none}
)";
  std::ofstream(folder / "sweep.yaml") << R"(schema_version: 1
name: sizes
command: reconstruct
experiments: small.yaml
vary: {mesh.max_volume: [1500 mm^3, 3000 mm^3]}
cases: [{frames.last: 3}]
)";
  const std::string cases = (folder / "cases").string();
  const std::string plan = "sweep plan " + (folder / "sweep.yaml").string() + " " + cases;
  const Ending refused = Lacuna(plan);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.said, HasSubstr("sweep.yaml:6:"));  // there are three frames, from 0
  std::string text = FileContent(folder / "sweep.yaml");
  text.erase(text.find("cases:"));
  std::ofstream(folder / "sweep.yaml") << text;
  ASSERT_EQ(Lacuna(plan).status, 0);
  EXPECT_THAT(Lacuna("sweep collect " + cases).said, HasSubstr("2 planned"));
  const Ending run = Lacuna("sweep run " + cases);
  EXPECT_EQ(run.status, 0) << run.said;
  const Ending table = Lacuna("sweep collect " + cases);
  EXPECT_EQ(table.status, 0);
  EXPECT_THAT(table.said, HasSubstr("2 cases of sizes: 2 done"));
  EXPECT_THAT(table.said, HasSubstr("animation_residual_m"));
  EXPECT_EQ(Lacuna("sweep collect " + cases).said, table.said);
  EXPECT_EQ(Lacuna("sweep run " + cases + " --wait").status, 2);
}

}  // namespace
}  // namespace lacuna
