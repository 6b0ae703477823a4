#include "support/check_effect.h"

#include <gtest/gtest.h>

#include "support/effect_in_motion.h"

namespace lacuna {
namespace {

void CheckCard(const EffectCard& card) {
  EXPECT_FALSE(card.type.empty());
  for (const std::string* text : {&card.title, &card.equation, &card.citation,
                                  &card.residual_when_missing, &card.separating_experiment}) {
    EXPECT_GT(text->size(), 5u) << card.type << ": a field of the card is missing";
  }
  for (const ParameterCard& parameter : card.parameters) {
    EXPECT_FALSE(parameter.name.empty()) << card.type;
    EXPECT_GT(parameter.meaning.size(), 5u) << card.type << '.' << parameter.name;
    EXPECT_LT(parameter.plausible_min, parameter.plausible_max) << card.type;
    EXPECT_GE(parameter.plausible_min, parameter.bounds.min) << card.type;
    EXPECT_LE(parameter.plausible_max, parameter.bounds.max) << card.type;
  }
}

}  // namespace

Eigen::VectorXd ForceAt(const Effect& effect, const Body& body, const Eigen::VectorXd& position,
                        const Eigen::VectorXd& velocity) {
  const Eigen::VectorXd acceleration = Eigen::VectorXd::Zero(position.size()), state;
  Eigen::VectorXd force = Eigen::VectorXd::Zero(position.size());
  effect.AddForce({body, position, velocity, acceleration, 0, 0.01, state}, &force);
  return force;
}

void CheckEffect(const Effect* effect, const CheckEffectOptions& options) {
  CheckCard(effect->Card());
  for (const int order : {1, 2}) {
    SCOPED_TRACE(effect->Card().type + " on elements of order " + std::to_string(order));
    const EffectInMotion moving(*effect, order, options);
    CheckEnergy(moving);
    CheckStress(moving);
    CheckTangents(moving);
    CheckTangentsAdd(moving);
    CheckDefiniteTangent(moving);
    CheckParameters(moving);
    CheckMemory(moving);
    CheckElasticityDerivatives(moving);
    CheckInvariances(moving);
    CheckThreads(moving);
  }
}

}  // namespace lacuna
