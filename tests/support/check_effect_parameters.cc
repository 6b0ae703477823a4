// The derivatives of an effect by its parameters, by those of the elasticity law that it refers to,
// and of its internal variables.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "support/effect_in_motion.h"

namespace lacuna {
namespace {

// The internal variables at the end of the step.
Eigen::VectorXd AtEnd(const Effect& effect, const Kinematics& at) {
  Eigen::VectorXd state = at.state;
  effect.AdvanceState(at, &state);
  return state;
}

}  // namespace

void CheckParameters(const EffectInMotion& moving) {
  const Effect& effect = moving.effect();
  const EffectCard& card = effect.Card();
  const Eigen::VectorXd values = effect.Parameters();
  ASSERT_EQ(values.size(), static_cast<Eigen::Index>(card.parameters.size()));
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const ParameterCard& parameter = card.parameters[k];
    if (parameter.setting) continue;
    Eigen::VectorXd derivative = Eigen::VectorXd::Zero(moving.size());
    effect.AddParameterDerivative(moving.Now(), static_cast<int>(k), &derivative);
    if (moving.options().without_influence.contains(parameter.name)) {
      EXPECT_EQ(derivative.norm(), 0) << "∂f/∂" << parameter.name << " was said to be zero";
      continue;
    }
    ASSERT_GT(derivative.norm(), 0) << "∂f/∂" << parameter.name << " is zero";
    const auto value = [&](double h) {
      return moving.ForceWith(values + h * Eigen::VectorXd::Unit(values.size(), k));
    };
    const double unit =
        values[k] != 0 ? std::abs(values[k]) : parameter.plausible_max - parameter.plausible_min;
    EXPECT_LT(BestError(value, derivative, 0.1 * unit), moving.options().tolerance)
        << "∂f/∂" << parameter.name;
    const Eigen::VectorXd other = values + 0.1 * unit * Eigen::VectorXd::Unit(values.size(), k);
    EXPECT_EQ(effect.WithParameters(other)->Parameters(), other) << parameter.name;
    EXPECT_EQ(effect.Parameters(), values) << "an effect does not change";
    // The first parameter is the size of the effect.
    if (k == 0 && !std::isnan(parameter.null_value)) {
      Eigen::VectorXd at_null = values;
      at_null[k] = parameter.null_value;
      EXPECT_LT(moving.ForceWith(at_null).norm(), moving.Force().norm())
          << "the null value of " << parameter.name << " weakens the effect";
    }
  }
}

// Derivatives by the parameters of the law that the effect refers to, at its own fixed force.
void CheckElasticityDerivatives(const EffectInMotion& moving) {
  const CheckEffectOptions& options = moving.options();
  if (options.elasticity == nullptr) return;
  const Eigen::VectorXd values = options.elasticity->Parameters();
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    Eigen::VectorXd derivative = Eigen::VectorXd::Zero(moving.size());
    moving.effect().AddElasticityDerivative(moving.Now(), static_cast<int>(k), &derivative);
    ASSERT_GT(derivative.norm(), 0) << "the force does not depend on the law";
    const auto value = [&](double h) {
      const auto law =
          options.elasticity->WithParameters(values + h * Eigen::VectorXd::Unit(values.size(), k));
      Kinematics at = moving.Now();
      at.elasticity = law.get();
      Eigen::VectorXd force = Eigen::VectorXd::Zero(moving.size());
      moving.effect().AddForce(at, &force);
      return force;
    };
    EXPECT_LT(BestError(value, derivative, 0.1 * values[k]), options.tolerance)
        << "by parameter " << k << " of the elasticity law";
  }
}

void CheckMemory(const EffectInMotion& moving) {
  const CheckEffectOptions& options = moving.options();
  const Effect& effect = moving.effect();
  if (moving.state().size() == 0) return;
  std::mt19937 random(options.seed + 2);
  const double scale = moving.state().lpNorm<Eigen::Infinity>();
  ASSERT_GT(scale, 0);
  const Eigen::MatrixXd changes = scale * RandomVector(moving.state().size(), &random);
  const Eigen::MatrixXd moved = 0.01 * RandomVector(moving.size(), &random);

  Eigen::MatrixXd forces = Eigen::MatrixXd::Zero(moving.size(), 1);
  effect.AddStateDerivatives(moving.Now(), changes, forces);
  const auto force = [&](double h) {
    const Eigen::VectorXd state = moving.state() + h * changes;
    Eigen::VectorXd sum = Eigen::VectorXd::Zero(moving.size());
    effect.AddForce(moving.Now().WithState(state), &sum);
    return sum;
  };
  EXPECT_LT(BestError(force, Eigen::VectorXd(forces), 1), options.tolerance) << "∂f/∂z";

  Eigen::MatrixXd at_end = changes;
  effect.AdvanceStateDerivatives(moving.Now(), moved, at_end);
  const auto advanced = [&](double h) {
    const Motion shifted = Shifted(moving.motion(), {.position = h}, moved);
    const Eigen::VectorXd state = moving.state() + h * changes;
    return AtEnd(effect, moving.At(shifted).WithState(state));
  };
  EXPECT_LT(BestError(advanced, Eigen::VectorXd(at_end), 1), options.tolerance)
      << "z at the end of the step";

  const EffectCard& card = effect.Card();
  const Eigen::VectorXd values = effect.Parameters();
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    if (card.parameters[k].setting) continue;
    Eigen::VectorXd derivative = Eigen::VectorXd::Zero(moving.state().size());
    effect.AddStateByParameter(moving.Now(), static_cast<int>(k), derivative);
    const auto value = [&](double h) {
      const auto other =
          effect.WithParameters(values + h * Eigen::VectorXd::Unit(values.size(), k));
      return AtEnd(*other, moving.Now());
    };
    const double unit = 0.1 * (values[k] != 0 ? std::abs(values[k]) : 1e-3);
    if (derivative.norm() == 0)
      EXPECT_EQ(value(1e-3 * unit), value(-1e-3 * unit)) << card.parameters[k].name;
    else
      EXPECT_LT(BestError(value, derivative, unit), options.tolerance)
          << "∂z/∂" << card.parameters[k].name;
  }
}

}  // namespace lacuna
