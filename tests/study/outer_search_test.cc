// The paper's search on a reduced bend: every fifth frame of the demo's recording, few evaluations.
#include "study/outer_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <string>

#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;

constexpr char kExperiment[] = R"(schema_version: 1
name: reduced
frames: {last: 15, every: 5}
surface: {of_frames: poisson, edge_length: 8 mm, samples_per_node: 1.5, point_weight: 8}
mesh: {radius_edge_ratio: 2.0, max_volume: 300 mm^3, preserve_surface: false}
material: {law: corotational, young_modulus: 0.1 MPa, poisson_ratio: 0.35}
forces: {model: smooth, length: 60 mm, traction_scale: 0.1 kPa}
fit: {noise: 0.3 mm, alignment_rounds: 1}
)";

// A modulus that is 30 times too high, which forces of this size cannot make up for.
constexpr char kSearch[] = R"(
radius_edge_ratio: {start: 2.0}
max_volume: {start: 300 mm^3}
young_modulus: {start: 3 MPa, lower: 0.01 MPa, upper: 10 MPa}
poisson_ratio: {start: 0.3, lower: 0.1, upper: 0.45}
evaluations: 10
)";

class OuterSearchTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    ProgressOptions silent;
    silent.style = ProgressStyle::kSilent;
    Progress progress(silent);
    const fs::path bend = fs::path(LACUNA_SOURCE_DIR) / "experiments/recordings/bend";
    study_ = new ReconstructionStudy(
        ReadReconstruction(Config::Parse(kExperiment, "reduced.yaml"), LoadRecording(bend)));
    states_ = new std::vector<FrameState>(LoadFrameStates(*study_, &progress));
    tracked_ = new TrackedFrames(TrackFrames(*study_, *states_, &progress));
  }
  static void TearDownTestSuite() {
    delete tracked_;
    delete states_;
    delete study_;
  }

  static OuterProblem Problem() { return {*study_, *states_, *tracked_, true, false, 0}; }
  static OuterSearchSettings Settings() {
    return ReadOuterSearch(Config::Parse(kSearch, "search.yaml"));
  }
  static OuterSearchResult Search(const OuterSearchSettings& settings, const fs::path& folder) {
    ProgressOptions silent;
    silent.style = ProgressStyle::kSilent;
    Progress progress(silent);
    return RunOuterSearch(Problem(), settings, folder, "reduced", &progress);
  }

  static ReconstructionStudy* study_;
  static std::vector<FrameState>* states_;
  static TrackedFrames* tracked_;
};
ReconstructionStudy* OuterSearchTest::study_ = nullptr;
std::vector<FrameState>* OuterSearchTest::states_ = nullptr;
TrackedFrames* OuterSearchTest::tracked_ = nullptr;

// The first `count` lines of a file, and a part of the next one.
void CutAfter(const fs::path& file, int count) {
  const std::string text = FileContent(file);
  size_t end = 0;
  for (int i = 0; i < count; ++i) end = text.find('\n', end) + 1;
  std::ofstream(file) << text.substr(0, end + 9);
}

TEST_F(OuterSearchTest, TheMaterialSearchLowersDAndAStoppedOneComesToTheSameResult) {
  const TemporaryFolder folder;
  const OuterSearchResult whole = Search(Settings(), folder / "whole");
  ASSERT_TRUE(whole.IsUsable());
  ASSERT_EQ(whole.evaluations.size(), 10u);
  const OuterEvaluation& start = whole.evaluations.front();
  const OuterEvaluation& best = whole.evaluations[whole.best];
  ASSERT_TRUE(start.usable);
  // A fifth is well under what is found and well above a change by the mesh, of which there is
  // none: only the material is searched.
  EXPECT_LT(best.residual_per_point, 0.8 * start.residual_per_point);
  EXPECT_LT(whole.parameters[whole.best].young_modulus, 1e6);
  EXPECT_EQ(start.nodes, best.nodes);

  // Stopped after four evaluations, while the fifth was being written.
  fs::create_directories(folder / "stopped");
  for (const char* name : {"search.log", "evaluations.jsonl"}) {
    fs::copy_file(folder / "whole" / name, folder / "stopped" / name);
    CutAfter(folder / "stopped" / name, 5);
  }
  const OuterSearchResult resumed = Search(Settings(), folder / "stopped");
  EXPECT_EQ(resumed.trace_hash, whole.trace_hash);
  EXPECT_EQ(resumed.best, whole.best);
  for (size_t k = 0; k < whole.evaluations.size(); ++k)
    EXPECT_EQ(resumed.evaluations[k].residual_sum, whole.evaluations[k].residual_sum) << k;
  EXPECT_EQ(FileContent(folder / "stopped/search.log"), FileContent(folder / "whole/search.log"));
}

TEST_F(OuterSearchTest, TheSumFollowsTheNumberOfPointsAndTheMeanDoesNot) {
  const OuterEvaluation coarse = EvaluateOuter(Problem(), {2.0, 3e-7, 1e5, 0.35});
  const OuterEvaluation fine = EvaluateOuter(Problem(), {2.0, 5e-8, 1e5, 0.35});
  ASSERT_TRUE(coarse.usable && fine.usable) << coarse.failure << fine.failure;
  ASSERT_GT(fine.surface_points, 1.3 * coarse.surface_points);
  EXPECT_GT(fine.residual_sum, 1.2 * coarse.residual_sum);
  // Another mesh moves the mean by a few per cent.
  EXPECT_NEAR(fine.residual_per_point / coarse.residual_per_point, 1, 0.15);
}

TEST_F(OuterSearchTest, ARefusedMeshIsAFailedEvaluation) {
  std::vector<FrameState> states = *states_;
  TriMesh& surface = states.front().surface;
  surface.triangles.conservativeResize(3, surface.triangles.cols() - 1);
  const OuterProblem problem{*study_, states, *tracked_, false, false, 0};
  const OuterEvaluation failed = EvaluateOuter(problem, {2.0, 3e-7, 1e5, 0.35});
  EXPECT_FALSE(failed.usable);
  EXPECT_NE(failed.failure.find("cannot be meshed"), std::string::npos) << failed.failure;
  EXPECT_TRUE(std::isnan(failed.residual_per_point));
}

TEST_F(OuterSearchTest, RegistrationInTheLoopAgreesWithTheTrackedFrames) {
  OuterProblem problem = Problem();
  const OuterParameters at{2.0, 3e-7, 1e5, 0.35};
  const OuterEvaluation tracked = EvaluateOuter(problem, at);
  problem.registration_in_loop = true;
  const OuterEvaluation in_loop = EvaluateOuter(problem, at);
  ASSERT_TRUE(tracked.usable && in_loop.usable);
  // Both follow the same scans to their noise of 0.3 mm.
  EXPECT_NEAR(in_loop.scan_distance, tracked.scan_distance, 1e-4);
}

TEST(OuterSearchSettingsTest, BoundsAreRefusedWhereTheyAreWrong) {
  std::string text = kSearch;
  text.replace(text.find("lower: 0.01 MPa, "), 17, "");
  EXPECT_THROW(ReadOuterSearch(Config::Parse(text, "s.yaml")), InputError);
  text = kSearch;
  text.replace(text.find("start: 3 MPa"), 12, "start: 30 MPa");
  EXPECT_THROW(ReadOuterSearch(Config::Parse(text, "s.yaml")), InputError);
}

}  // namespace
}  // namespace lacuna
