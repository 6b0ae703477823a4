// An effect on a random deformed body that moves, and the checks of it that make up CheckEffect()
// (check_effect.h).
#ifndef LACUNA_TESTS_SUPPORT_EFFECT_IN_MOTION_H_
#define LACUNA_TESTS_SUPPORT_EFFECT_IN_MOTION_H_

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <limits>
#include <random>

#include "support/check_effect.h"

namespace lacuna {

struct Motion {
  Eigen::VectorXd position, velocity, acceleration;
};

// A block whose elements all differ, moved and deformed at random.
struct MovingBody {
  Body body;
  Motion motion = {};
  Eigen::VectorXd state = {};  // after a step with other strains than now
};

// A block of cells of 20 mm, each cut into linear or quadratic elements (`order` 1 or 2).
MovingBody MakeMovingBody(const Effect& effect, int order, const std::array<int, 3>& cells,
                          const CheckEffectOptions& options);

// Independent numbers between −1 and 1.
Eigen::VectorXd RandomVector(Eigen::Index size, std::mt19937* random);

// The motion with its position, velocity and acceleration changed by `shift` times their weight.
Motion Shifted(const Motion& motion, const TangentWeights& by, const Eigen::VectorXd& shift);

// The smallest relative error of `analytic` against central differences of `value`, a function of
// one number about 0, over step sizes from coarse (truncation) to fine (rounding) in terms of
// `unit`.
template <typename Value, typename Result>
double BestError(const Value& value, const Result& analytic, double unit) {
  double best = std::numeric_limits<double>::infinity();
  for (const double relative : {1e-3, 1e-4, 1e-5, 1e-6}) {
    const double h = relative * unit;
    const Result difference = (value(h) - value(-h)) / (2 * h);
    best = std::min(best, (difference - analytic).norm() / analytic.norm());
  }
  return best;
}

// The effect and the options must outlive it.
class EffectInMotion {
 public:
  EffectInMotion(const Effect& effect, int order, const CheckEffectOptions& options);

  const Effect& effect() const { return effect_; }
  int order() const { return order_; }
  const CheckEffectOptions& options() const { return options_; }
  const Body& body() const { return moving_.body; }
  const Motion& motion() const { return moving_.motion; }
  const Eigen::VectorXd& state() const { return moving_.state; }
  Eigen::Index size() const { return moving_.motion.position.size(); }  // of positions and forces

  // Without inertia the accelerations of the motion must be 0.
  Kinematics At(const Motion& motion, bool has_inertia = true) const;
  Kinematics Now() const { return At(moving_.motion); }
  Eigen::VectorXd Force(const Motion& motion, bool has_inertia = true) const;
  Eigen::VectorXd Force() const { return Force(moving_.motion); }
  // The force at the motion of the body with other parameter values.
  Eigen::VectorXd ForceWith(const Eigen::VectorXd& values) const;
  Eigen::MatrixXd Tangent(const TangentWeights& weights, bool convexify) const;
  // Expects that the effect tells whether there is a skew part.
  Eigen::MatrixXd SkewTangent(const TangentWeights& weights) const;

 private:
  const Effect& effect_;
  const CheckEffectOptions& options_;
  const int order_;
  const MovingBody moving_;
};

// f = −∂E/∂x with an energy E wherever there is a potential, and f = −Σ w P ∂N/∂X
// (check_effect_forces.cc).
void CheckEnergy(const EffectInMotion& moving);
void CheckStress(const EffectInMotion& moving);
// Tangents against central differences, their sums, and the definite ones that replace them
// (check_effect_tangents.cc).
void CheckTangents(const EffectInMotion& moving);
void CheckTangentsAdd(const EffectInMotion& moving);
void CheckDefiniteTangent(const EffectInMotion& moving);
// Derivatives by the parameters of the effect and of the elasticity law that it refers to, and of
// its internal variables (check_effect_parameters.cc).
void CheckParameters(const EffectInMotion& moving);
void CheckElasticityDerivatives(const EffectInMotion& moving);
void CheckMemory(const EffectInMotion& moving);
// Momentum and the choice of a frame of reference, and the number of threads
// (check_effect_forces.cc).
void CheckInvariances(const EffectInMotion& moving);
void CheckThreads(const EffectInMotion& moving);

}  // namespace lacuna

#endif  // LACUNA_TESTS_SUPPORT_EFFECT_IN_MOTION_H_
