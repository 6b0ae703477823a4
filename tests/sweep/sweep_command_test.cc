#include "sweep/sweep_command.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

namespace lacuna {
namespace {

FrameRecord Followed(int frame, double distance, bool usable) {
  FrameRecord record;
  record.frame = frame;
  record.surface_distance_mean = distance;
  record.solver.usable = usable;
  record.solver.message = usable ? "" : "no convergence";
  return record;
}

// The first frame is the reference shape, which lies on its own scan; the last was not followed.
RunRecord ThreeFrames() {
  RunRecord record;
  record.object_size = 0.1;
  record.frames = {Followed(0, 0, true), Followed(5, 2e-3, true),
                   Followed(10, kNotMeasured, false)};
  record.measures = {
      {"noise_m", 3e-4}, {"residual_per_point_m", 1e-3}, {"surface_distance_mean_m", 2e-3}};
  return record;
}

double NumberOf(const CaseOutcome& outcome, const std::string& name) {
  for (const auto& [key, value] : outcome.numbers)
    if (key == name) return value;
  ADD_FAILURE() << "no " << name;
  return kNotMeasured;
}

TEST(SweepCommand, TheDistanceOfAReconstructionIsThatOfTheFramesThatWereFollowed) {
  const CaseOutcome outcome = OutcomeOf(ThreeFrames());
  EXPECT_FALSE(outcome.done);
  EXPECT_EQ(outcome.message, "frame 10: no convergence");
  EXPECT_EQ(NumberOf(outcome, "surface_distance_mean_m"), 2e-3);
  EXPECT_EQ(NumberOf(outcome, "residual_per_point_m"), 1e-3);
  EXPECT_EQ(NumberOf(outcome, "noise_m"), 3e-4);
  EXPECT_EQ(NumberOf(outcome, "frames_unusable"), 1);
  std::set<std::string> names;
  for (const auto& [name, value] : outcome.numbers)
    EXPECT_TRUE(names.insert(name).second) << name << " stands twice";
  EXPECT_FALSE(names.contains("scan_distance_m"));
}

// The run ends at the first frame that cannot be followed.
TEST(SweepCommand, FramesThatWereNotTriedAreUnusable) {
  RunRecord record = ThreeFrames();
  record.frames_not_tried = 16;
  EXPECT_EQ(NumberOf(OutcomeOf(record), "frames"), 19);
  EXPECT_EQ(NumberOf(OutcomeOf(record), "frames_unusable"), 17);
}

// A word of the same name as a number would be a second column of that name.
TEST(SweepCommand, EachColumnOfAFitHasANameOfItsOwn) {
  CalibrationRecord record;
  record.usable = true;
  record.parameters.resize(2);
  record.parameters[0].name = "young_modulus";
  record.parameters[0].unit = "Pa";
  record.parameters[0].estimate.value = 29000;
  record.parameters[0].estimate.low = 40000;
  record.parameters[0].at_limit = 75000;
  record.parameters[1].name = "poisson_ratio";
  const CaseOutcome outcome = OutcomeOf(record);
  EXPECT_TRUE(outcome.done);
  EXPECT_EQ(NumberOf(outcome, "young_modulus_Pa"), 29000);
  EXPECT_EQ(NumberOf(outcome, "young_modulus_at_limit_Pa"), 75000);
  EXPECT_EQ(NumberOf(outcome, "young_modulus_low_Pa"), 40000);
  EXPECT_TRUE(std::isnan(NumberOf(outcome, "poisson_ratio_at_limit")));
  std::set<std::string> names;
  for (const auto& [name, value] : outcome.numbers) EXPECT_TRUE(names.insert(name).second) << name;
  for (const auto& [name, text] : outcome.words) EXPECT_TRUE(names.insert(name).second) << name;
  EXPECT_TRUE(names.contains("young_modulus_verdict"));
  EXPECT_TRUE(names.contains("poisson_ratio_verdict"));
}

TEST(SweepCommand, WhatAReconstructionHasNotMeasuredIsEmpty) {
  RunRecord record = ThreeFrames();
  record.measures.clear();
  EXPECT_TRUE(std::isnan(NumberOf(OutcomeOf(record), "surface_distance_mean_m")));
}

}  // namespace
}  // namespace lacuna
