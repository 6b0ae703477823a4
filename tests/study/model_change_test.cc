#include "study/model_change.h"

#include <gtest/gtest.h>

#include <cmath>

#include "effects/catalogue.h"
#include "study/held_bar.h"

namespace lacuna {
namespace {

TEST(WithEffect, LooksForAPlaceOnTheBody) {
  PredictionStudy study;
  study.effects = {MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}})};
  const Body body = MakeBody(BarMesh({4, 1, 1}, 1), 1000);
  ScoredEffect scored;
  for (const CandidateEffect& candidate : MakeCandidates({body, study.effects, 0.001, 1}))
    if (candidate.type == "attached_mass") scored.candidate = candidate;
  ASSERT_NE(scored.candidate.effect, nullptr);
  scored.score.size = Eigen::VectorXd::Constant(1, 0.001);

  const PredictionStudy with = WithEffect(study, scored);
  ASSERT_EQ(with.effects.size(), 2u);
  int places = 0;
  for (const ModelParameter& parameter : with.fitted) {
    const CalibratedParameter& prior = parameter.prior;
    if (prior.name.find("centre_") == std::string::npos) continue;
    const bool is_along = prior.name.ends_with("x");
    EXPECT_NEAR(prior.min, is_along ? 0 : -0.01, 1e-12) << prior.name;
    EXPECT_NEAR(prior.max, is_along ? 0.08 : 0.01, 1e-12) << prior.name;
    EXPECT_NEAR(prior.prior_mean, is_along ? 0.04 : 0, 1e-12) << prior.name;
    // Of an even distribution.
    EXPECT_NEAR(prior.prior_deviation, (prior.max - prior.min) / std::sqrt(12.0), 1e-12);
    EXPECT_GE(prior.start, prior.min);
    EXPECT_LE(prior.start, prior.max);
    ++places;
  }
  EXPECT_EQ(places, 3);
}

}  // namespace
}  // namespace lacuna
