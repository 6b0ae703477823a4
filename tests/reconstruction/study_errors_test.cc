// What a user gets wrong in an experiment or a scene, and what the program says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "core/npy.h"
#include "experiment/scene.h"
#include "geometry/mesh_io.h"
#include "geometry/rounded_box.h"
#include "reconstruction/reconstruction.h"
#include "reconstruction/reconstruction_study.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

// The message that reading the demo's experiment gives after one change.
std::string MessageAfter(const std::string& from, const std::string& to) {
  const TemporaryFolder folder;
  const std::filesystem::path experiments =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments";
  std::string text = FileContent(experiments / "bend.yaml");
  const auto replace = [&text](const std::string& a, const std::string& b) {
    const size_t at = text.find(a);
    EXPECT_NE(at, std::string::npos) << a;
    text.replace(at, a.size(), b);
  };
  replace("recordings/bend/truth", (experiments / "recordings/bend/truth").string());
  replace(from, to);
  if (from.find("recording:") == std::string::npos)
    replace("recording: recordings/bend",
            "recording: " + (experiments / "recordings/bend").string());
  std::ofstream(folder / "e.yaml") << text;
  try {
    ReadReconstruction(Config::Load(folder / "e.yaml"));
  } catch (const InputError& problem) {
    return problem.what();
  }
  return "nothing was refused";
}

using testing::ContainsRegex;
using testing::HasSubstr;

TEST(StudyErrors, NameTheLineAndTheField) {
  EXPECT_THAT(MessageAfter("poisson_ratio: 0.35", "poisson_ratio: 0.5"),
              ContainsRegex("e.yaml:[0-9]+:[0-9]+: material.poisson_ratio: got \"0.5\""));
  EXPECT_THAT(MessageAfter("young_modulus: 0.1 MPa", "young_modulus: 0.1"),
              HasSubstr("a unit is missing"));
  EXPECT_THAT(MessageAfter("radius_edge_ratio", "radius_edge_ration"),
              HasSubstr("mesh.radius_edge_ration: unknown key; did you mean "
                        "\"radius_edge_ratio\"?"));
  EXPECT_THAT(MessageAfter("law: corotational", "law: corotated"),
              HasSubstr("did you mean \"corotational\"?"));
  EXPECT_THAT(MessageAfter("model: smooth", "model: footprint"), HasSubstr("needs a region"));
  EXPECT_THAT(MessageAfter("schema_version: 1", "schema_version: 2"),
              HasSubstr("schema_version: got \"2\""));
  EXPECT_THAT(MessageAfter("recording: recordings/bend", "recording: recordings/bent"),
              HasSubstr("bent"));
  EXPECT_THAT(MessageAfter("recordings/bend/truth", "recordings/bend/lies"),
              HasSubstr("validation.true_surfaces: there is no "));
  EXPECT_THAT(MessageAfter("{every: 1}", "{last: 0}"), HasSubstr("has one frame"));
  EXPECT_THAT(
      MessageAfter("poisson_ratio: 0.35", "poison_ratio: 0.35"),
      HasSubstr("material.poisson_ratio: is missing (\"poison_ratio\" is not a known key)"));
  const std::string gravity = "{type: gravity, acceleration: [0, 0, -9.81 m/s^2]}";
  EXPECT_THAT(MessageAfter("effects: []", "effects: [" + gravity + ", " + gravity + "]"),
              HasSubstr("effects[1].type: gravity is listed twice"));
  EXPECT_THAT(MessageAfter("name: bend\n", "name: ..\n"),
              ContainsRegex("e.yaml:[0-9]+:[0-9]+: name: names a folder"));
  EXPECT_THAT(MessageAfter("output: ../results/bend ", "output: \"\" "),
              HasSubstr("output: is empty"));
  EXPECT_THAT(MessageAfter("seed: 1", "registration: {outlier_weight: 0.9}"),
              HasSubstr("registration.outlier_weight: got \"0.9\""));
  EXPECT_EQ(MessageAfter("seed: 1", "registration: {outlier_weight: 0.8}"), "nothing was refused");
  EXPECT_THAT(MessageAfter("model: smooth",
                           "hold_net_force: true, model: footprint, region: "
                           "{sphere: {center: [0, 0, 0], radius: 1 m}}"),
              HasSubstr("forces.hold_net_force: leaves no force of a footprint"));
}

TEST(StudyErrors, KnownAnswersAreCheckedBeforeTheRun) {
  const TemporaryFolder folder;
  WriteNpy(folder / "forces.npy", Eigen::MatrixXd::Zero(16, 2));
  EXPECT_THAT(MessageAfter("validation: {",
                           "validation: {true_forces: " + (folder / "forces.npy").string() + ", "),
              ContainsRegex("e.yaml:[0-9]+:[0-9]+: validation.true_forces: .*forces.npy: is an "
                            "array of 16 × 2; expected frames × 3"));
  WriteNpy(folder / "forces.npy", Eigen::MatrixXd::Zero(16, 3));
  EXPECT_EQ(MessageAfter("validation: {",
                         "validation: {true_forces: " + (folder / "forces.npy").string() + ", "),
            "nothing was refused");
  // The folder lacks the surfaces of the frames.
  std::filesystem::create_directories(folder / "truth");
  const std::filesystem::path truth =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/recordings/bend/truth";
  EXPECT_THAT(MessageAfter(truth.string(), (folder / "truth").string()),
              ContainsRegex("validation.true_surfaces: .*triangles.npy"));
  // Every surface is read, the last one, too.
  std::filesystem::copy(truth, folder / "truth");
  WriteNpy(folder / "truth/vertices_015.npy", Eigen::MatrixXd::Zero(2, 5));
  EXPECT_THAT(MessageAfter(truth.string(), (folder / "truth").string()),
              ContainsRegex("validation.true_surfaces: .*vertices_015.npy: is an array of 2 × 5"));
}

// The surfaces are sound, and checked before the other files.
TEST(StudyErrors, AMissingKnownAnswerIsReportedUnderItsOwnKey) {
  EXPECT_THAT(MessageAfter("validation: {", "validation: {true_forces: absent.npy, "),
              ContainsRegex("e.yaml:[0-9]+:[0-9]+: validation.true_forces: there is no "
                            ".*absent.npy"));
}

TEST(StudyErrors, TheUnchangedExperimentIsSound) {
  EXPECT_EQ(MessageAfter("seed: 1", "seed: 2"), "nothing was refused");
}

// The demo's experiment with more entries, on a recording in `folder` of its frames and a given
// mesh, with more entries, too.
ReconstructionStudy ReadWithGivenMesh(const TemporaryFolder& folder, const std::string& experiment,
                                      const std::string& recording) {
  const std::filesystem::path experiments =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments";
  WriteTriMesh(folder / "box.ply", RoundedBox({0.05, 0.015, 0.015}, {0.1, 0.03, 0.03}, 0, 0.01));
  std::ofstream(folder / "recording.yaml")
      << "schema_version: 1\nname: bent\nlength_unit: m\ndensity: 1000 kg/m^3\ndata_folder: "
      << (experiments / "recordings/bend").string()
      << "\nframes: {kind: points, pattern: frames/points_%03d.ply, count: 16, rate: 20 Hz}\n"
      << "reference: {from: mesh, file: box.ply}\n"
      << recording;
  std::ofstream(folder / "e.yaml") << "use: " << (experiments / "bend.yaml").string()
                                   << "\noutput: run\nrecording: " << folder.Path().string() << "\n"
                                   << experiment;
  return ReadReconstruction(Config::Load(folder / "e.yaml"));
}

// The last frame is at 0.75 s.
TEST(StudyErrors, APathMustCoverTheFrames) {
  const TemporaryFolder folder;
  const auto read = [&folder](const std::string& end) {
    std::ofstream(folder / "arm.csv") << "t,x,y,z\n0,0,0,0\n" << end << ",0,0,0.01\n";
    ReadWithGivenMesh(folder, "",
                      "gripped: [{sphere: {center: [0, 0, 0], radius: 5 mm}, path: {file: " +
                          (folder / "arm.csv").string() + ", time: t, x: x, y: y, z: z}}]\n");
  };
  EXPECT_THAT([&] { read("0.5"); }, testing::ThrowsMessage<InputError>(HasSubstr(
                                        "arm.csv covers 0 s to 0.5 s, the frames 0 s to 0.75 s")));
  EXPECT_NO_THROW(read("0.74999")) << "rounded";
}

// The experiment names the file, not the recording.
TEST(StudyErrors, TheNodesWhereForcesActAreAnInputOfTheRun) {
  const TemporaryFolder folder;
  std::ofstream(folder / "pushed_nodes.txt") << "1\n3\n";
  const ReconstructionStudy study = ReadWithGivenMesh(
      folder, "forces: {region: {nodes_file: " + (folder / "pushed_nodes.txt").string() + "}}\n",
      "");
  std::ofstream(folder / "pushed_nodes.txt", std::ios::app) << "\n";
  SilentProgress progress;
  EXPECT_THAT([&] { RunReconstruction(study, &progress); },
              testing::ThrowsMessage<InputError>(
                  testing::AllOf(HasSubstr("pushed_nodes.txt"), HasSubstr("has changed"))));
}

TEST(StudyErrors, ValuesFarFromTheUsualAreAWarning) {
  const auto effects = [](const char* modulus) {
    return ReadEffects(Config::Parse(
        std::string("material: {law: linear, poisson_ratio: 0.3, young_modulus: ") + modulus + "}",
        "e.yaml"));
  };
  EXPECT_TRUE(ImplausibleParameters(effects("0.1 MPa"), kReferenceBody).empty());
  const auto warnings = ImplausibleParameters(effects("210 GPa"), kReferenceBody);
  ASSERT_EQ(warnings.size(), 1u);
  EXPECT_THAT(warnings[0], HasSubstr("young_modulus"));
}

TEST(StudyErrors, ASceneIsCheckedBeforeItRuns) {
  const std::filesystem::path file =
      std::filesystem::path(LACUNA_SOURCE_DIR) / "experiments/scenes/bend.yaml";
  EXPECT_NO_THROW(ReadScene(Config::Load(file)));
  std::string text = FileContent(file);
  text.replace(text.find("edge_radius: 5 mm"), 17, "edge_radius: 50 mm");
  EXPECT_THROW(ReadScene(Config::Parse(text, file.string())), InputError);
}

}  // namespace
}  // namespace lacuna
