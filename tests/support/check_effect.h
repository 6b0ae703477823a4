// What every physical effect must satisfy, checked with one call.
#ifndef LACUNA_TESTS_SUPPORT_CHECK_EFFECT_H_
#define LACUNA_TESTS_SUPPORT_CHECK_EFFECT_H_

#include <Eigen/Core>
#include <set>
#include <string>

#include "fem/effect.h"

namespace lacuna {

struct CheckEffectOptions {
  double strain = 0.2;      // size of the random deformation; the body is rotated by 1 rad as well
  double strain_rate = 3;   // 1/s, of the random velocity
  double time = 0.3;        // s
  double time_step = 0.01;  // s
  // Relative error of a derivative against central differences at the best of several step sizes.
  double tolerance = 1e-6;
  bool depends_on_position = true;  // ∂f/∂x must differ from 0; else it must be 0
  bool depends_on_velocity = false;
  bool depends_on_acceleration = false;
  // Whether the effect knows the potential of its force, where that has one. A law of the user does
  // not.
  bool has_known_energy = true;
  unsigned seed = 7;
  // The elasticity law of the body, for an effect that is defined relative to it. Its derivatives
  // by the parameters of the law are then checked too.
  const Effect* elasticity = nullptr;
  // Parameters that have no influence at the values of the effect: the derivative must be 0.
  std::set<std::string> without_influence = {};
};

// The nodal forces of an effect without memory on a body that moves without acceleration, at time
// 0 in a step of 10 ms.
Eigen::VectorXd ForceAt(const Effect& effect, const Body& body, const Eigen::VectorXd& position,
                        const Eigen::VectorXd& velocity);

// At a random deformed state, moving with inertia, for linear and quadratic elements:
//  - the card is complete and its parameters agree with Parameters() and WithParameters();
//  - with and without inertia, the effect has an energy E if and only if its force has a potential,
//    because it depends on the positions only and its derivative by them is symmetric; then
//    f = −∂E/∂x;
//  - f = −Σ w P ∂N/∂X where the effect is a stress;
//  - AddTangents and AddSkewTangents together, and AddParameterDerivative, agree with central
//    differences, for all weights and every parameter that is not a setting, and are not simply
//    zero; they add into what is there, in proportion to the weight;
//  - the tangent with `convexify` is symmetric and negative semi-definite;
//  - forces and torques sum to zero where the card says so; then the forces are the same, but
//    turned, in a frame that is turned, shifted and spinning;
//  - forces and tangents are bit-identical for one and for two threads.
void CheckEffect(const Effect* effect, const CheckEffectOptions& options = {});

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_CHECK_EFFECT_H_
