#include "diagnosis/model_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "effects/catalogue.h"
#include "support/held_bar.h"

namespace lacuna {
namespace {

PredictionStudy ElasticBar() {
  PredictionStudy study;
  study.effects = {MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}})};
  return study;
}

// The last variant of the effect.
CandidateEffect CandidateFor(const PredictionStudy& study, const std::string& type) {
  const Body body = MakeBody(BarMesh({4, 1, 1}, 1), 1000);
  CandidateEffect found;
  for (const CandidateEffect& candidate : MakeCandidates({body, study.effects, 0.001, 1}))
    if (candidate.type == type) found = candidate;
  return found;
}

TEST(WithEffect, LooksForAPlaceOnTheBody) {
  const PredictionStudy study = ElasticBar();
  ScoredEffect scored;
  scored.candidate = CandidateFor(study, "attached_mass");
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
    // Of a uniform distribution.
    EXPECT_NEAR(prior.prior_deviation, (prior.max - prior.min) / std::sqrt(12.0), 1e-12);
    EXPECT_GE(prior.start, prior.min);
    EXPECT_LE(prior.start, prior.max);
    ++places;
  }
  EXPECT_EQ(places, 3);
}

// The place of a support moves along its side; across it, the place is held.
TEST(WithEffect, MovesASupportAlongItsSide) {
  const PredictionStudy study = ElasticBar();
  ScoredEffect scored;
  const Body body = MakeBody(BarMesh({4, 1, 1}, 1), 1000);
  for (const CandidateEffect& candidate : MakeCandidates({body, study.effects, 0.001, 1}))
    if (candidate.variant == "on the −z side at x = 40 mm") scored.candidate = candidate;
  ASSERT_EQ(scored.candidate.type, "elastic_support");
  scored.score.size = Eigen::VectorXd::Constant(1, 1e5);
  std::map<std::string, CalibratedParameter> fitted;
  for (const ModelParameter& parameter : WithEffect(study, scored).fitted)
    fitted[parameter.prior.name] = parameter.prior;
  ASSERT_EQ(fitted.size(), 3u);
  const CalibratedParameter &along = fitted.at("elastic_support.point_x"),
                            &radius = fitted.at("elastic_support.radius");
  EXPECT_EQ(fitted.at("elastic_support.modulus").start, 1e5);
  EXPECT_NEAR(along.start, 0.04, 1e-12);
  EXPECT_NEAR(along.max, 0.08, 1e-12);
  ASSERT_TRUE(radius.log_scale);
  EXPECT_NEAR(radius.prior_mean, 0.08 / 6, 1e-12);
  EXPECT_NEAR(radius.max / radius.min, 16, 1e-9);
  // Of a uniform distribution of the logarithm.
  EXPECT_NEAR(radius.prior_deviation, std::log(16.0) / std::sqrt(12.0), 1e-12);
}

// An angle may leave its plausible range, because the directions at both ends are neighbours; a
// size may not.
TEST(WithEffect, LetsAnAngleTurnPastTheEndOfItsRange) {
  const PredictionStudy study = ElasticBar();
  ScoredEffect scored;
  scored.candidate = CandidateFor(study, "fibre_stiffness");
  ASSERT_NE(scored.candidate.effect, nullptr);
  const EffectCard& card = scored.candidate.effect->Card();
  const int azimuth = ParameterIndex(card, "azimuth");
  const double end = card.parameters[azimuth].plausible_max;
  const double range = end - card.parameters[azimuth].plausible_min;
  Eigen::VectorXd values = scored.candidate.effect->Parameters();
  values[azimuth] = 0.9 * end;
  scored.candidate.effect = FindEntry("fibre_stiffness")->make(values);
  scored.score.size = Eigen::VectorXd::Constant(1, 1e4);

  int angles = 0;
  for (const ModelParameter& parameter : WithEffect(study, scored).fitted) {
    const CalibratedParameter& prior = parameter.prior;
    if (prior.name.ends_with("azimuth")) {
      EXPECT_NEAR(prior.min, 0.9 * end - range, 1e-12);
      EXPECT_NEAR(prior.max, 0.9 * end + range, 1e-12);
      ++angles;
    }
    if (prior.name.ends_with("modulus")) {
      EXPECT_LT(prior.max, 2 * card.parameters[parameter.places.front().index].plausible_max);
    }
  }
  EXPECT_EQ(angles, 1);
}

}  // namespace
}  // namespace lacuna
