#include "diagnosis/model_change.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "diagnosis/candidates.h"
#include "effects/catalogue.h"
#include "support/held_bar.h"

namespace lacuna {
namespace {

PredictionStudy ElasticBar(double young_modulus = 1e5) {
  PredictionStudy study;
  study.effects = {
      MakeEffect("neo_hookean", {{"young_modulus", young_modulus}, {"poisson_ratio", 0.4}})};
  study.density = 1000;
  study.recordings.resize(1);
  study.recordings[0].recording.size = 0.1;
  return study;
}

// The last variant of the effect.
CandidateEffect CandidateFor(const PredictionStudy& study, const std::string& type) {
  const Body body = MakeBody(BarMesh({4, 1, 1}, 1), 1000);
  CandidateEffect found;
  for (const CandidateEffect& candidate :
       MakeCandidates({body, study.effects, ScaleOf(study), 0.001, 1}))
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

// Masses that are added to the body fall with its gravity, whichever of the two is added first, and
// also while gravity is fitted.
TEST(WithEffect, LetsAddedMassesFallWithTheGravityThatIsFitted) {
  for (const bool gravity_first : {true, false}) {
    PredictionStudy study = ElasticBar();
    const CandidateEffect mass = CandidateFor(study, "attached_mass");
    const CandidateEffect gravity = CandidateFor(study, "gravity");
    for (const bool adds_gravity : {gravity_first, !gravity_first}) {
      ScoredEffect scored;
      scored.candidate = adds_gravity ? gravity : mass;
      scored.score.size = adds_gravity ? Eigen::VectorXd(Eigen::Vector3d(1, 2, -9))
                                       : Eigen::VectorXd(Eigen::VectorXd::Constant(1, 0.001));
      study = WithEffect(study, scored);
    }
    ASSERT_EQ(study.effects.size(), 3u);
    const Effect& added = *study.effects[gravity_first ? 2 : 1];
    ASSERT_EQ(added.Card().type, "attached_mass");
    EXPECT_EQ(added.Parameters().tail<3>(), Eigen::Vector3d(1, 2, -9)) << gravity_first;
    Eigen::VectorXd values(static_cast<Eigen::Index>(study.fitted.size()));
    for (size_t k = 0; k < study.fitted.size(); ++k)
      values[static_cast<Eigen::Index>(k)] = study.fitted[k].prior.name == "gravity.acceleration_y"
                                                 ? 0.5
                                                 : study.fitted[k].prior.start;
    const EffectList fitted = WithValues(study.effects, study.fitted, values);
    for (const size_t effect : {1u, 2u})
      if (fitted[effect]->Card().type == "attached_mass") {
        EXPECT_EQ(fitted[effect]->Parameters().tail<3>(), Eigen::Vector3d(1, 0.5, -9))
            << gravity_first;
      }
  }
}

// A mass whose weight is known while the model has no gravity, because the reference shape was
// measured under it, does not fall with a gravity that a diagnosis adds.
TEST(WithEffect, LeavesTheKnownWeightOfAMass) {
  const auto with_gravity = [](double of_mass) {
    PredictionStudy study = ElasticBar();
    study.effects.push_back(MakeEffect("attached_mass", {{"mass", 0.002},
                                                         {"centre_x", 0.08},
                                                         {"centre_y", 0},
                                                         {"centre_z", 0},
                                                         {"gravity_x", 0},
                                                         {"gravity_y", 0},
                                                         {"gravity_z", of_mass}}));
    ScoredEffect scored;
    scored.candidate = CandidateFor(study, "gravity");
    scored.score.size = Eigen::Vector3d(1, 2, -0.3);
    return WithEffect(study, scored);
  };
  for (const double of_mass : {-9.81, 0.0}) {
    const PredictionStudy with = with_gravity(of_mass);
    ASSERT_EQ(with.effects.size(), 3u);
    const Eigen::Vector3d own(0, 0, of_mass), added(1, 2, -0.3);
    EXPECT_EQ(with.effects[1]->Parameters().tail<3>(), of_mass == 0 ? added : own);
    EXPECT_EQ(with.fitted.size(), 3u);
    for (const ModelParameter& parameter : with.fitted)
      EXPECT_EQ(parameter.places.size(), of_mass == 0 ? 2u : 1u) << parameter.prior.name;
  }
}

// In a body of 5 MPa a branch may have half of that, and a prior that does not speak against it.
TEST(WithEffect, LooksForStiffBranchesInStiffBodies) {
  const PredictionStudy study = ElasticBar(5e6);
  ScoredEffect scored;
  scored.candidate = CandidateFor(study, "viscoelastic_branch");
  ASSERT_NE(scored.candidate.effect, nullptr);
  EXPECT_DOUBLE_EQ(AmountsOf(scored.candidate).front().plausible, 1.5e7);
  scored.score.size = Eigen::VectorXd::Constant(1, 2.5e6);
  EXPECT_EQ(StartOfRefit(scored)[scored.candidate.amplitude.front()], 2.5e6);
  for (const ModelParameter& parameter : WithEffect(study, scored).fitted) {
    if (parameter.prior.name != "viscoelastic_branch.modulus") continue;
    EXPECT_EQ(parameter.prior.start, 2.5e6);
    EXPECT_GT(parameter.prior.max, 1.5e7);
    EXPECT_DOUBLE_EQ(parameter.prior.prior_deviation, 1.5e7);
    return;
  }
  ADD_FAILURE() << "the modulus is not fitted";
}

// The card of swelling has an open bound, at which the body vanishes. Far inside it, a bound of the
// refit is an ordinary one, which the fit may reach.
TEST(WithEffect, ClosesTheBoundsOfPlausibleValues) {
  const PredictionStudy study = ElasticBar();
  ScoredEffect scored;
  scored.candidate = CandidateFor(study, "swelling");
  ASSERT_NE(scored.candidate.effect, nullptr);
  ASSERT_TRUE(scored.candidate.effect->Card().parameters[0].bounds.open_min);
  scored.score.size = Eigen::VectorXd::Constant(1, 0.01);
  const PredictionStudy with = WithEffect(study, scored);
  ASSERT_EQ(with.fitted.size(), 1u);
  EXPECT_GT(with.fitted[0].prior.min, -0.9);
  EXPECT_FALSE(with.fitted[0].prior.open_min);
}

// The place of a support moves along its side; across it, the place is held.
TEST(WithEffect, MovesASupportAlongItsSide) {
  const PredictionStudy study = ElasticBar();
  ScoredEffect scored;
  const Body body = MakeBody(BarMesh({4, 1, 1}, 1), 1000);
  for (const CandidateEffect& candidate :
       MakeCandidates({body, study.effects, ScaleOf(study), 0.001, 1}))
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
  EXPECT_FALSE(radius.open_min) << "a range within the body";
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
