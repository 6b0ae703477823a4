// The paper's search on a reduced bend: every fifth frame of the demo's recording, few evaluations.
#include "paper/parameter_search.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <string>

#include "paper/evaluation_record.h"
#include "paper/reduced_bend.h"
#include "reconstruction/reconstruction_study.h"
#include "support/replace_in_file.h"
#include "support/silent_progress.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

// A modulus that is 30 times too high, which forces of this size cannot make up for.
constexpr char kSearch[] = R"(
radius_edge_ratio: {start: 2.0}
max_volume: {start: 300 mm^3}
young_modulus: {start: 3 MPa, lower: 0.01 MPa, upper: 10 MPa}
poisson_ratio: {start: 0.3, lower: 0.1, upper: 0.45}
evaluations: 10
)";

class ParameterSearchTest : public ReducedBendTest {
 protected:
  static ParameterSearchSettings Settings() {
    return ReadParameterSearch(Config::Parse(kSearch, "search.yaml"));
  }
  static ParameterSearchResult Search(const ParameterSearchSettings& settings,
                                      const fs::path& folder) {
    SilentProgress progress;
    return RunParameterSearch(Problem(), settings, folder, "reduced", &progress);
  }
};

// The first `count` lines of a file, and a part of the next one.
void CutAfter(const fs::path& file, int count) {
  const std::string text = FileContent(file);
  size_t end = 0;
  for (int i = 0; i < count; ++i) end = text.find('\n', end) + 1;
  std::ofstream(file) << text.substr(0, end + 9);
}

TEST_F(ParameterSearchTest, TheMaterialSearchLowersDAndAStoppedOneComesToTheSameResult) {
  const TemporaryFolder folder;
  const ParameterSearchResult whole = Search(Settings(), folder / "whole");
  ASSERT_TRUE(whole.IsUsable());
  ASSERT_EQ(whole.evaluations.size(), 10u);
  const ObjectiveEvaluation& start = whole.evaluations.front();
  const ObjectiveEvaluation& best = whole.evaluations[whole.best];
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
  const ParameterSearchResult resumed = Search(Settings(), folder / "stopped");
  EXPECT_EQ(resumed.trace_hash, whole.trace_hash);
  EXPECT_EQ(resumed.best, whole.best);
  for (size_t k = 0; k < whole.evaluations.size(); ++k)
    EXPECT_EQ(resumed.evaluations[k].residual_sum, whole.evaluations[k].residual_sum) << k;
  EXPECT_EQ(FileContent(folder / "stopped/search.log"), FileContent(folder / "whole/search.log"));

  // A record that was changed since does not pass for what was searched.
  const std::string record = FileContent(folder / "stopped/evaluations.jsonl");
  std::string changed =
      std::regex_replace(record, std::regex("(residual_per_point[^:]*\":)0\\.00"), "$010.01");
  ASSERT_NE(changed, record);
  std::ofstream(folder / "stopped/evaluations.jsonl") << changed;
  EXPECT_THROW(Search(Settings(), folder / "stopped"), InputError);
}

TEST_F(ParameterSearchTest, TheSumFollowsTheNumberOfPointsAndTheMeanDoesNot) {
  const ObjectiveEvaluation coarse = EvaluateObjective(Problem(), {2.0, 3e-7, 1e5, 0.35});
  const ObjectiveEvaluation fine = EvaluateObjective(Problem(), {2.0, 5e-8, 1e5, 0.35});
  ASSERT_TRUE(coarse.usable && fine.usable) << coarse.failure << fine.failure;
  ASSERT_GT(fine.surface_points, 1.3 * coarse.surface_points);
  EXPECT_GT(fine.residual_sum, 1.2 * coarse.residual_sum);
  // Another mesh moves the mean by a few per cent.
  EXPECT_NEAR(fine.residual_per_point / coarse.residual_per_point, 1, 0.15);
}

TEST_F(ParameterSearchTest, ARefusedMeshIsAFailedEvaluation) {
  std::vector<FrameState> states = Scans().states;
  TriMesh& surface = states.front().surface;
  surface.triangles.conservativeResize(3, surface.triangles.cols() - 1);
  const ParameterObjective problem{.study = Scans().study,
                                   .states = states,
                                   .tracked = Scans().tracked,
                                   .remesh_surface = false};
  const ObjectiveEvaluation failed = EvaluateObjective(problem, {2.0, 3e-7, 1e5, 0.35});
  EXPECT_FALSE(failed.usable);
  EXPECT_NE(failed.failure.find("cannot be meshed"), std::string::npos) << failed.failure;
  EXPECT_TRUE(std::isnan(failed.residual_per_point));
}

TEST_F(ParameterSearchTest, RegistrationInTheLoopAgreesWithTheTrackedFrames) {
  ParameterObjective problem = Problem();
  const SearchedParameters at{2.0, 3e-7, 1e5, 0.35};
  const ObjectiveEvaluation tracked = EvaluateObjective(problem, at);
  problem.registration_in_loop = true;
  const ObjectiveEvaluation in_loop = EvaluateObjective(problem, at);
  ASSERT_TRUE(tracked.usable && in_loop.usable);
  // Both follow the same scans to their noise of 0.3 mm.
  EXPECT_NEAR(in_loop.scan_distance, tracked.scan_distance, 1e-4);
}

// The derivative of what is measured by y (i = 0) or p (i = 1) with the central differences over
// several steps, relative to the value's own size over a parameter's scale.
void ExpectSlopes(const ParameterObjective& problem, double tolerance) {
  const SearchedParameters at{2.0, 3e-7, 1.5e5, 0.35};
  const ObjectiveEvaluation evaluation = EvaluateObjective(problem, at);
  ASSERT_TRUE(evaluation.usable) << evaluation.failure;
  ASSERT_EQ(evaluation.by_moduli.size(), 2u);
  for (const size_t i : {0u, 1u}) {
    const double scale = i == 0 ? at.young_modulus : at.poisson_ratio;
    for (const double step : {0.1, 0.03}) {
      SearchedParameters below = at, above = at;
      (i == 0 ? below.young_modulus : below.poisson_ratio) -= step * scale;
      (i == 0 ? above.young_modulus : above.poisson_ratio) += step * scale;
      const ObjectiveEvaluation from = EvaluateObjective(problem, below);
      const ObjectiveEvaluation to = EvaluateObjective(problem, above);
      ASSERT_TRUE(from.usable && to.usable);
      const ObjectiveSlope& slope = evaluation.by_moduli[i];
      const auto expect = [&](double given, double high, double low, const char* name) {
        const double difference = (high - low) / (2 * step);
        EXPECT_NEAR(scale * given, difference, tolerance * std::abs(difference) + 2e-3 * high)
            << name << " by " << (i == 0 ? "y" : "p") << ", step " << step;
      };
      expect(slope.residual_sum, to.residual_sum, from.residual_sum, "sum");
      expect(slope.residual_per_point, to.residual_per_point, from.residual_per_point, "mean");
      expect(slope.residual_rms, to.residual_rms, from.residual_rms, "rms");
    }
  }
}

TEST_F(ParameterSearchTest, TheDerivativesByTheModuliAgreeWithDifferences) {
  // A body that bends by its weight, in a recording without: D grows as it gets softer.
  const std::string text = WithReplacements(
      kReducedBend,
      {{"forces: {model: smooth, length: 60 mm, traction_scale: 0.1 kPa}",
        "forces: {model: none}\neffects: [{type: gravity, acceleration: [0, 0, -9.81 m/s^2]}]"}});
  const ReconstructionStudy study = ReadReconstruction(Config::Parse(text, "reduced.yaml"),
                                                       LoadRecording(ReducedBendRecording()));
  ParameterObjective problem = Problem(study);
  problem.slopes = true;
  // The curvature of D over a tenth of y.
  ExpectSlopes(problem, 0.1);
}

TEST_F(ParameterSearchTest, WhereForcesAreFittedThereAreNoDerivatives) {
  ParameterObjective problem = Problem();
  EXPECT_FALSE(CanDifferentiate(problem));
  problem.slopes = true;
  const ObjectiveEvaluation evaluation = EvaluateObjective(problem, {2.0, 3e-7, 1e5, 0.35});
  ASSERT_TRUE(evaluation.usable);
  EXPECT_TRUE(evaluation.by_moduli.empty());
}

TEST_F(ParameterSearchTest, TheGradientSearchLowersDAndAStoppedOneComesToTheSameResult) {
  const TemporaryFolder folder;
  ParameterSearchSettings settings = Settings();
  settings.method = SearchMethod::kCeres;
  settings.evaluations = 8;
  const ParameterSearchResult whole = Search(settings, folder / "whole");
  ASSERT_TRUE(whole.IsUsable());
  // As of the search without derivatives above.
  EXPECT_LT(whole.evaluations[whole.best].residual_per_point,
            0.8 * whole.evaluations.front().residual_per_point);
  fs::create_directories(folder / "stopped");
  for (const char* name : {"search.log", "evaluations.jsonl"}) {
    fs::copy_file(folder / "whole" / name, folder / "stopped" / name);
    CutAfter(folder / "stopped" / name, 4);
  }
  EXPECT_EQ(Search(settings, folder / "stopped").trace_hash, whole.trace_hash);

  // The points that are read back from the log are not evaluated by the search itself, but their
  // derivatives stand in the record alone. What it has lost is computed again.
  const fs::path record = folder / "stopped/evaluations.jsonl";
  fs::remove(record);
  const ParameterSearchResult refilled = Search(settings, folder / "stopped");
  EXPECT_EQ(refilled.trace_hash, whole.trace_hash);
  for (size_t k = 0; k < whole.evaluations.size(); ++k)
    EXPECT_EQ(refilled.evaluations[k].residual_sum, whole.evaluations[k].residual_sum) << k;
  std::string lines = FileContent(record);
  const size_t second = lines.find('\n') + 1;
  lines.erase(second, lines.find('\n', second) + 1 - second);
  std::ofstream(record) << lines;
  EXPECT_EQ(Search(settings, folder / "stopped").trace_hash, whole.trace_hash);
}

// What the messages about a damaged log advise: nothing that was computed is lost.
TEST_F(ParameterSearchTest, WithoutItsLogASearchTakesTheSamePathThroughTheRecord) {
  const TemporaryFolder folder;
  ParameterSearchSettings settings = Settings();
  settings.evaluations = 4;
  const ParameterSearchResult whole = Search(settings, folder / "search");
  const std::string log = FileContent(folder / "search/search.log");
  const std::string record = FileContent(folder / "search/evaluations.jsonl");
  fs::remove(folder / "search/search.log");
  EXPECT_EQ(Search(settings, folder / "search").trace_hash, whole.trace_hash);
  EXPECT_EQ(FileContent(folder / "search/search.log"), log);
  EXPECT_EQ(FileContent(folder / "search/evaluations.jsonl"), record);
}

// An evaluation that failed in the record and has a value in the log, as after an update.
TEST_F(ParameterSearchTest, AFailureInTheRecordDoesNotPassForAValueInTheLog) {
  const TemporaryFolder folder;
  ParameterSearchSettings settings = Settings();
  settings.evaluations = 1;
  const ParameterSearchResult whole = Search(settings, folder / "search");
  const fs::path file = folder / "search/evaluations.jsonl";
  fs::remove(file);
  ObjectiveEvaluation failed;
  failed.failure = "frame 5: no convergence";
  EvaluationRecord(file, "reduced").Append(whole.parameters.front(), failed);
  EXPECT_THAT([&] { Search(settings, folder / "search"); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("evaluations.jsonl"), HasSubstr("has another value"))));
}

TEST_F(ParameterSearchTest, TheMeasuresAreOfTheSameLengths) {
  const ObjectiveEvaluation evaluation = EvaluateObjective(Problem(), {2.0, 3e-7, 1e5, 0.35});
  ASSERT_TRUE(evaluation.usable);
  EXPECT_GT(evaluation.residual_rms, evaluation.residual_per_point);      // Jensen's inequality
  EXPECT_LT(evaluation.residual_rms, 3 * evaluation.residual_per_point);  // no heavy tail
  EXPECT_EQ(ValueOf(evaluation, ObjectiveMeasure::kRms), evaluation.residual_rms);
}

TEST(ParameterSearchSettingsTest, AKeyThatTheMethodIgnoresIsRefused) {
  const auto read = [](const std::string& lines) {
    return ReadParameterSearch(Config::Parse(std::string(kSearch) + lines, "s.yaml"));
  };
  EXPECT_EQ(read("").cobyla.restarts.max_restarts, 20);
  EXPECT_EQ(read("restarts: 0\n").cobyla.restarts.max_restarts, 0);
  EXPECT_EQ(read("restarts: 3\nmethod: cobyla_1994\n").cobyla.restarts.max_restarts, 3);
  for (const char* method : {"gaussian_process", "nlopt_cobyla", "nlopt_bobyqa", "ceres"}) {
    EXPECT_NO_THROW(read(std::string("method: ") + method + "\n")) << method;
    EXPECT_THAT([&] { read(std::string("restarts: 3\nmethod: ") + method + "\n"); },
                ThrowsMessage<InputError>(
                    HasSubstr("restarts: acts with method cobyla or cobyla_1994 only")))
        << method;
  }
  EXPECT_EQ(read("difference: 0.05\nmethod: ceres\n").difference, 0.05);
  EXPECT_THROW(read("difference: 0.05\n"), InputError);
  EXPECT_EQ(read("seed: 3\nmethod: gaussian_process\n").seed, 3u);
  EXPECT_THROW(read("seed: 3\n"), InputError);
}

TEST(ParameterSearchSettingsTest, BoundsAreRefusedWhereTheyAreWrong) {
  const auto read = [](const std::map<std::string, std::string>& replaced) {
    ReadParameterSearch(Config::Parse(WithReplacements(kSearch, replaced), "s.yaml"));
  };
  EXPECT_NO_THROW(read({}));
  EXPECT_THROW(read({{"lower: 0.01 MPa, ", ""}}), InputError);
  // BOBYQA needs two parameters at least; here the modulus alone is searched.
  EXPECT_THROW(read({{", lower: 0.1, upper: 0.45", ""},
                     {"evaluations: 10\n", "evaluations: 10\nmethod: nlopt_bobyqa\n"}}),
               InputError);
  // No tetrahedron's radius is so short beside its edges.
  EXPECT_THROW(read({{"radius_edge_ratio: {start: 2.0}", "radius_edge_ratio: {start: 1}"}}),
               InputError);
  // A start above the upper bound.
  EXPECT_THROW(read({{"start: 3 MPa", "start: 30 MPa"}}), InputError);
}

}  // namespace
}  // namespace lacuna
