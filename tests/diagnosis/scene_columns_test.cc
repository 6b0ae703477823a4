#include "diagnosis/scene_columns.h"

#include <gtest/gtest.h>

namespace lacuna {
namespace {

NuisanceCandidate Nuisance(const std::string& name, bool shrinks_with_time_step, double unit) {
  NuisanceCandidate nuisance;
  nuisance.card.name = name;
  nuisance.card.shrinks_with_time_step = shrinks_with_time_step;
  nuisance.columns = Eigen::VectorXd::LinSpaced(10, 0, 9 * unit);
  nuisance.unknown = 10 * nuisance.columns;
  return nuisance;
}

TEST(SceneColumns, OfAnotherStepLackWhatTheStepDetermines) {
  SceneColumns scene{{Nuisance("mesh", false, 1), Nuisance("time_step", true, 1)},
                     PilotHypotheses{}};
  const SceneColumns other = scene.ForOtherStep();
  ASSERT_EQ(other.nuisances.size(), 1u);
  EXPECT_EQ(other.nuisances[0].card.name, "mesh");
  EXPECT_FALSE(other.pilots.has_value());
}

// Two recordings of three frames with two series, and of two frames with two series.
TEST(SceneColumns, OfTheFirstFramesHaveTheirRows) {
  SceneColumns scene{{Nuisance("mesh", false, 1)}, PilotHypotheses{}};
  std::vector<LinearisedMisfit::Part> whole(2);
  whole[0].layout.series = whole[1].layout.series = 2;
  whole[0].layout.times = {0, 1, 2};
  whole[1].layout.times = {0, 1};
  whole[1].first_row = 6;
  std::vector<PredictedRecording> beginnings(2);
  beginnings[0].frames = {0, 1};
  beginnings[1].frames = {0};
  const SceneColumns first = scene.ForFirstFrames(whole, beginnings);
  const Eigen::MatrixXd& columns = first.nuisances.at(0).columns;
  EXPECT_EQ(columns, (Eigen::MatrixXd(6, 1) << 0, 1, 2, 3, 6, 7).finished());
  EXPECT_EQ(first.nuisances[0].unknown, 10 * columns);
}

}  // namespace
}  // namespace lacuna
