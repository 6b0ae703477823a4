#include "diagnosis/scored_beside.h"

#include <gtest/gtest.h>

#include <cmath>

#include "diagnosis/projected_hypotheses.h"
#include "diagnosis/synthetic_space.h"

namespace lacuna {
namespace {

ScoredVariant VariantWith(const std::string& variant, double evidence) {
  ScoredVariant scored;
  scored.candidate.type = "drag";
  scored.candidate.variant = variant;
  scored.score.evidence = evidence;
  return scored;
}

// The evidence of a variant contains the penalties for its selection once.
TEST(ScoredBeside, ChangesNothingWhereTheBaseIsTheSame) {
  const SyntheticSpace columns;
  const HypothesisSpace space = columns.With(SyntheticSpace::Noise(1) + 12 * columns.Of("drag"));
  const ProjectedHypotheses beside(space);
  const Eigen::VectorXd factors = beside.FactorsOfResidual();
  std::vector<ScoredEffect> effects;
  for (size_t h = 0; h < space.hypotheses.size(); ++h) {
    if (space.hypotheses[h].kind != HypothesisKind::kEffect) continue;
    ScoredEffect& effect = effects.emplace_back();
    effect.candidate.type = space.hypotheses[h].name;
    effect.score.evidence = factors[static_cast<Eigen::Index>(h)] - std::log(4);
  }
  ASSERT_EQ(effects.size(), 4u);
  const double of_drag = effects.front().score.evidence;
  ASSERT_GT(of_drag, 10);
  const std::vector<ScoredEffect> scored = ScoredBeside(space, effects);
  EXPECT_EQ(scored.front().candidate.type, "drag");
  EXPECT_NEAR(scored.front().score.evidence, of_drag, 1e-9);
}

// The base explains what one variant explained, but not what the other does.
TEST(ScoredBeside, ScoresEachVariantByItself) {
  SyntheticSpace columns;
  columns.hypotheses.front().variant = "here";
  columns.Add(HypothesisKind::kEffect, "drag", columns.Of("fibres"));
  columns.hypotheses.back().variant = "there";
  const HypothesisSpace space = columns.With(SyntheticSpace::Noise(1) + 15 * columns.Of("fibres"));
  ScoredEffect drag;
  static_cast<ScoredVariant&>(drag) = VariantWith("here", 50);
  drag.elsewhere = {VariantWith("there", 45), VariantWith("of another space", 30)};
  const ScoredEffect scored = ScoredBeside(space, {drag}).front();
  EXPECT_EQ(scored.candidate.variant, "there");
  EXPECT_EQ(scored.score.evidence, 45);
  ASSERT_EQ(scored.elsewhere.size(), 2u);
  EXPECT_EQ(scored.elsewhere[0].candidate.variant, "of another space");
  EXPECT_EQ(scored.elsewhere[1].candidate.variant, "here");
  EXPECT_LT(scored.elsewhere[1].score.evidence, 10);
}

}  // namespace
}  // namespace lacuna
