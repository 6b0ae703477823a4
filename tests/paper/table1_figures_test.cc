// Figures 3 to 6 on a reduced bend: every fifth frame of the demo's recording.
#include "paper/table1_figures.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "core/error.h"
#include "experiment/kept_recording.h"
#include "paper/evaluation_record.h"
#include "paper/reduced_bend.h"
#include "report/arrow_mesh.h"
#include "support/temporary_folder.h"

namespace lacuna {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

constexpr char kSearch[] = R"(
radius_edge_ratio: {start: 2.0}
max_volume: {start: 300 mm^3}
young_modulus: {start: 0.1 MPa}
poisson_ratio: {start: 0.35}
)";

class Table1FiguresTest : public ReducedBendTest {
 protected:
  static void SetUpTestSuite() {
    ReducedBendTest::SetUpTestSuite();
    table1_ = new Table1Study;
    table1_->configurations.push_back({"all",
                                       Config::Parse(kReducedBend, "reduced.yaml"),
                                       ReadParameterSearch(Config::Parse(kSearch, "search.yaml")),
                                       {}});
    table1_->scene_key = "a scene";
    table1_->true_young_modulus = 1e5;
    table1_->true_poisson_ratio = 0.35;
    settings_ =
        new Table1FigureSettings{{}, 3, {1.5, 3.0}, {5e-8, 3e-7}, {{1.1, 3.0}, 1, 0}, {1, 3}, {3}};
  }
  static void TearDownTestSuite() {
    delete table1_;
    delete settings_;
    ReducedBendTest::TearDownTestSuite();
  }

  static Table1Study* table1_;
  static Table1FigureSettings* settings_;
};
Table1Study* Table1FiguresTest::table1_ = nullptr;
Table1FigureSettings* Table1FiguresTest::settings_ = nullptr;

TEST_F(Table1FiguresTest, CloudIsSplitIntoKeptAndRemovedAndTheSurfaceIsNearTheTruth) {
  const FigureContent figure = DrawCloudAndSurface(Scans(), *settings_);
  ASSERT_EQ(figure.picture.panels.size(), 2u);
  const std::vector<PanelPoints>& points = figure.picture.panels[0].points;
  ASSERT_EQ(points.size(), 2u);
  EXPECT_EQ(points[0].points.cols() + points[1].points.cols(), figure.numbers.at("points"));
  EXPECT_GT(points[1].points.cols(), 0) << "the filter removes flying points";
  EXPECT_GT(points[0].points.cols(), 20 * points[1].points.cols());
  // The scanner's noise is 0.3 mm, which the surface averages; triangles of 8 mm cut its corners.
  EXPECT_LT(figure.numbers.at("surface_to_truth_mean_m"), 0.6e-3);
}

TEST_F(Table1FiguresTest, ASmallerVGivesMoreTetrahedraAndEachMeshIsCutOpen) {
  const FigureContent figure = DrawMeshes(*table1_, Scans(), *settings_);
  ASSERT_EQ(figure.picture.panels.size(), 4u);
  for (const Panel& panel : figure.picture.panels)
    EXPECT_GT(panel.surfaces[1].mesh.triangles.cols(), 0) << panel.title;
  const auto tets = [&](size_t k) { return figure.numbers[k].at("tetrahedra").get<int>(); };
  EXPECT_GT(tets(0), tets(1));  // v
  EXPECT_GT(tets(2), tets(3));
  // TetGen may keep the tighter q without being asked to.
  EXPECT_GE(tets(0), tets(2));
}

// With S_0's own triangles and no other bound, q alone decides on the tetrahedra.
TEST_F(Table1FiguresTest, QActsWhereTheSurfaceIsKeptAndVDoesNot) {
  const FigureContent figure = DrawOwnSurfaceMeshes(*table1_, Scans(), *settings_);
  ASSERT_EQ(figure.numbers.size(), 2u);
  const auto number = [&](size_t mesh, const char* name) {
    return figure.numbers[mesh].at(name).get<double>();
  };
  EXPECT_GT(number(0, "tetrahedra"), 1.3 * number(1, "tetrahedra"));
  EXPECT_GT(number(1, "largest_radius_edge_ratio"), 1.3 * number(0, "largest_radius_edge_ratio"));
  EXPECT_GT(number(1, "mean_aspect_ratio"), 1.2 * number(0, "mean_aspect_ratio"));
}

TEST_F(Table1FiguresTest, ArrowsShowTheRegisteredDisplacement) {
  const FigureContent figure = DrawBend(*table1_, Scans(), *settings_);
  ASSERT_EQ(figure.picture.panels.size(), 4u);
  for (size_t k = 0; k < 2; ++k) {
    const PanelSurface& arrows = figure.picture.panels[k].surfaces[1];
    const double longest = figure.numbers[k].at("registered_max_m");
    EXPECT_LE(arrows.vertex_values.maxCoeff(), 1e3 * longest * (1 + 1e-12));
    EXPECT_GT(arrows.vertex_values.maxCoeff(), 500 * longest);
    EXPECT_EQ(arrows.mesh.vertices.cols() % kArrowVertices, 0);
    // Fitted forces bring the body to where the scans have it; elements of 14 mm cut the corners.
    EXPECT_LT(figure.numbers[k].at("points_to_simulation_mean_m"), 2e-3);
  }
  EXPECT_GT(figure.numbers[1].at("simulated_max_m"), figure.numbers[0].at("simulated_max_m"));
}

TEST_F(Table1FiguresTest, AFrameWhoseRegistrationFailedHasNoDisplacement) {
  Table1Scans scans = Scans();
  scans.tracked.failures.at(3) = "no overlap";
  EXPECT_THAT([&] { DrawBend(*table1_, scans, *settings_); },
              ThrowsMessage<InputError>(HasSubstr("registration of frame 3 failed (no overlap)")));
}

TEST_F(Table1FiguresTest, OptimaAreReadFromTheTableAndMeasureWhatItHas) {
  const TemporaryFolder folder;
  EXPECT_THAT([&] { DrawAlignment(*table1_, Scans(), *settings_, folder / "."); },
              ThrowsMessage<InputError>(HasSubstr("run `lacuna table1` first")));
  const SearchedParameters optimum{2, 3e-7, 1e5, 0.35};
  const ObjectiveEvaluation found = EvaluateObjective(Problem(), optimum);
  ASSERT_TRUE(found.usable) << found.failure;
  const nlohmann::json search{
      {"seed", 1},
      {"name", "all"},
      {"best", {{"parameters", ToJson(optimum)}, {"evaluation", ToJson(found)}}}};
  std::ofstream(folder / "table1.json")
      << nlohmann::json{{"searches", nlohmann::json::array({search})}};
  EXPECT_THAT([&] { DrawAlignment(*table1_, Scans(), *settings_, folder / "."); },
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("another scene"), HasSubstr("with another `--output`"))));
  fs::create_directories(folder / "seed_1/recording");
  std::ofstream(folder / "seed_1/recording/a.ply") << "ply\n";
  MarkRecording(folder / "seed_1/recording", RecordingKey(*table1_, 1));
  const FigureContent figure = DrawAlignment(*table1_, Scans(), *settings_, folder / ".");
  ASSERT_EQ(figure.numbers.size(), 1u);
  EXPECT_EQ(figure.numbers[0].at("residual_per_point_m"), found.residual_per_point);
  ASSERT_EQ(figure.picture.panels.size(), 1u);
  const Eigen::VectorXd& distance = figure.picture.panels[0].surfaces[0].vertex_values;
  EXPECT_NEAR(1e-3 * distance.mean(), figure.numbers[0].at("distances")[0].at("mean_m"), 1e-15);
  EXPECT_LT(distance.mean(), 1) << "mm; the body follows the scan";

  std::ofstream(folder / "seed_1/recording/a.ply") << "another\n";
  EXPECT_THAT([&] { DrawAlignment(*table1_, Scans(), *settings_, folder / "."); },
              ThrowsMessage<InputError>(HasSubstr("was changed")));
}

}  // namespace
}  // namespace lacuna
