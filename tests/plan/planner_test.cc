#include "plan/planner.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"
#include "plan/planned_bar.h"

namespace lacuna {
namespace {

using ::testing::HasSubstr;
using Kind = HypothesisProbability::Kind;

HypothesisProbability Probable(Kind kind, const std::vector<std::string>& names,
                               double probability) {
  HypothesisProbability one;
  one.kind = kind;
  one.names = names;
  one.probability = probability;
  return one;
}

TEST(RivalsOf, AreTheEffectsAmongTheMostProbableHypotheses) {
  DiagnosisRecord diagnosis;
  diagnosis.decision.probabilities = {
      Probable(Kind::kEffect, {"mass_damping"}, 0.50), Probable(Kind::kEffect, {"drag"}, 0.30),
      Probable(Kind::kNuisance, {"mesh"}, 0.12), Probable(Kind::kPair, {"drag", "gravity"}, 0.05),
      Probable(Kind::kEffect, {"pressure"}, 0.03)};
  diagnosis.decision.power.resize(1);
  diagnosis.decision.power[0].truth = {"drag"};
  diagnosis.decision.power[0].named = 0.25;
  const std::vector<PlannedRival> rivals = RivalsOf(diagnosis);
  ASSERT_EQ(rivals.size(), 3u);
  EXPECT_EQ(rivals[0].effect, "mass_damping");
  EXPECT_EQ(rivals[0].named_now, 0);
  EXPECT_EQ(rivals[1].effect, "drag");
  EXPECT_EQ(rivals[1].probability, 0.30);
  EXPECT_EQ(rivals[1].named_now, 0.25);
  EXPECT_EQ(rivals[2].effect, "gravity");  // of the pair, without a probability of its own
  EXPECT_EQ(rivals[2].probability, 0);
}

TEST(MakePlan, SaysThatNothingIsLeftToBeDecided) {
  const PlannedBar bar;
  FittedRun fitted;
  fitted.study = bar.study;
  fitted.mesh = bar.mesh;
  DiagnosisRecord diagnosis;
  diagnosis.decision.probabilities = {Probable(Kind::kEffect, {"drag"}, 1)};
  ProgressOptions silent;
  silent.style = ProgressStyle::kSilent;
  Progress progress(silent);
  try {
    MakePlan({fitted, diagnosis, {}}, {}, &progress);
    ADD_FAILURE() << "a plan without rivals";
  } catch (const InputError& problem) {
    EXPECT_THAT(problem.what(), HasSubstr("has left no rivals"));
  }
}

}  // namespace
}  // namespace lacuna
