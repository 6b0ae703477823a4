// The forces of an effect: they follow from its energy and its stress, conserve momentum, and
// depend neither on the frame of reference nor on the number of threads.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "core/parallel.h"
#include "support/effect_in_motion.h"

namespace lacuna {
namespace {

// The sums of nodal forces and of their torques about the origin.
struct Resultants {
  Eigen::Vector3d force = Eigen::Vector3d::Zero(), torque = Eigen::Vector3d::Zero();
  double force_size = 0, torque_size = 0;  // the sums of |f| and of |x| |f|
};

Resultants ResultantsOf(const Eigen::VectorXd& position, const Eigen::VectorXd& force) {
  Resultants sum;
  for (Eigen::Index i = 0; i < force.size() / 3; ++i) {
    const Eigen::Vector3d f = force.segment<3>(3 * i);
    const Eigen::Vector3d x = position.segment<3>(3 * i);
    sum.force += f;
    sum.torque += x.cross(f);
    sum.force_size += f.norm();
    sum.torque_size += x.norm() * f.norm();
  }
  return sum;
}

// Whether the force has a potential: it depends on the positions only, and its derivative by them
// is symmetric (Poincaré's lemma). Without inertia the accelerations are 0.
bool HasPotential(const EffectInMotion& moving, bool has_inertia) {
  const CheckEffectOptions& options = moving.options();
  if (options.depends_on_velocity || (options.depends_on_acceleration && has_inertia)) return false;
  BlockMatrix skew(moving.body().pattern);
  return !moving.effect().AddSkewTangents(moving.Now(), {.position = 1}, &skew);
}

// In a step with or without inertia.
void CheckEnergyOfStep(const EffectInMotion& moving, bool has_inertia) {
  const Effect& effect = moving.effect();
  Motion motion = moving.motion();
  if (!has_inertia) motion.acceleration.setZero();
  const std::optional<double> energy = effect.Energy(moving.At(motion, has_inertia));
  const bool has_potential = HasPotential(moving, has_inertia);
  ASSERT_TRUE(!energy || has_potential) << "the force has no potential, but an energy";
  ASSERT_TRUE(energy || !has_potential || !moving.options().has_known_energy)
      << "the force has a potential, but no energy";
  if (!energy) return;
  ASSERT_TRUE(std::isfinite(*energy));
  std::mt19937 random(moving.options().seed + 1);
  const Eigen::VectorXd force = moving.Force(motion, has_inertia);
  ASSERT_GT(force.norm(), 0);
  for (int k = 0; k < 3; ++k) {
    // A component along the force itself keeps the derivative away from zero.
    const Eigen::VectorXd direction = RandomVector(moving.size(), &random) + force / force.norm();
    const auto value = [&](double h) {
      const Motion shifted = Shifted(motion, {.position = h}, direction);
      return Eigen::Matrix<double, 1, 1>(-*effect.Energy(moving.At(shifted, has_inertia)));
    };
    const Eigen::Matrix<double, 1, 1> power(force.dot(direction));
    EXPECT_LT(BestError(value, power, 0.001), moving.options().tolerance) << "f = −∂E/∂x";
  }
}

}  // namespace

void CheckEnergy(const EffectInMotion& moving) {
  for (const bool has_inertia : {true, false}) {
    SCOPED_TRACE(has_inertia ? "with inertia" : "without inertia");
    CheckEnergyOfStep(moving, has_inertia);
  }
}

// The stress, where the effect is one, integrates to the forces.
void CheckStress(const EffectInMotion& moving) {
  const Body& body = moving.body();
  Eigen::Matrix3Xd stress = Eigen::Matrix3Xd::Zero(3, 3 * body.PointCount());
  if (!moving.effect().AddStress(moving.Now(), &stress)) {
    EXPECT_TRUE(stress.isZero(0)) << "an effect that is no stress added one";
    return;
  }
  Eigen::VectorXd force = Eigen::VectorXd::Zero(moving.size());
  for (int q = 0; q < body.PointCount(); ++q) {
    const Eigen::Matrix3d P = body.weight[q] * stress.middleCols<3>(3 * q);
    const auto gradient = body.shape_gradient.middleCols<3>(3 * q);
    for (Eigen::Index a = 0; a < gradient.rows(); ++a)
      force.segment<3>(3 * body.mesh.tets(a, q / body.points_per_element)) -=
          P * gradient.row(a).transpose();
  }
  const Eigen::VectorXd expected = moving.Force();
  EXPECT_LT((force - expected).norm(), 1e-12 * expected.norm()) << "f = −Σ w P ∂N/∂X";
}

void CheckInvariances(const EffectInMotion& moving) {
  const EffectCard& card = moving.effect().Card();
  const Eigen::VectorXd force = moving.Force();
  const Resultants sum = ResultantsOf(moving.motion().position, force);
  // Rounding of a few hundred additions.
  if (card.conserves_momentum) {
    EXPECT_LT(sum.force.norm(), 1e-12 * sum.force_size) << "forces sum to zero";
  }
  if (!card.conserves_angular_momentum) return;
  EXPECT_LT(sum.torque.norm(), 1e-12 * sum.torque_size) << "torques sum to zero";

  // Seen from a frame turned, shifted and spinning, the forces are the same but turned.
  const Eigen::Matrix3d Q =
      Eigen::AngleAxisd(2.2, Eigen::Vector3d(0.3, 1, -0.7).normalized()).toRotationMatrix();
  const Eigen::Vector3d spin(4, -2, 3), shift(0.3, 0.1, -0.2);
  Motion seen = moving.motion();
  Eigen::VectorXd turned(moving.size());
  for (Eigen::Index i = 0; i < moving.size() / 3; ++i) {
    const Eigen::Vector3d x = Q * moving.motion().position.segment<3>(3 * i);
    seen.position.segment<3>(3 * i) = x + shift;
    seen.velocity.segment<3>(3 * i) =
        Q * moving.motion().velocity.segment<3>(3 * i) + spin.cross(x);
    turned.segment<3>(3 * i) = Q * force.segment<3>(3 * i);
  }
  // Positions of 0.3 m are known to 5e-17 m, strains of 0.02 m elements to 1e-14.
  EXPECT_LT((moving.Force(seen) - turned).norm(), 1e-11 * force.norm())
      << "the same in a turned and spinning frame";
}

void CheckThreads(const EffectInMotion& moving) {
  const CheckEffectOptions& options = moving.options();
  const Effect& effect = moving.effect();
  // Large enough that several threads find work.
  const MovingBody large = MakeMovingBody(effect, moving.order(), {7, 6, 5}, options);
  const Motion& motion = large.motion;
  const Kinematics at{large.body,          motion.position,   motion.velocity, motion.acceleration,
                      options.time,        options.time_step, large.state,     options.elasticity,
                      /*has_inertia=*/true};
  const int threads = ThreadCount();
  Eigen::VectorXd force[2];
  BlockMatrix tangent[2] = {BlockMatrix(large.body.pattern), BlockMatrix(large.body.pattern)};
  for (const int k : {0, 1}) {
    SetThreadCount(1 + k);
    force[k] = Eigen::VectorXd::Zero(motion.position.size());
    effect.AddForce(at, &force[k]);
    effect.AddTangents(at, {1, 1, 1}, false, &tangent[k]);
    effect.AddSkewTangents(at, {1, 1, 1}, &tangent[k]);
  }
  SetThreadCount(threads);
  EXPECT_EQ(force[0], force[1]);
  const int values = 9 * large.body.pattern->BlockCount();
  EXPECT_TRUE(std::equal(tangent[0].values(), tangent[0].values() + values, tangent[1].values()))
      << "the same tangent on one thread and on two";
}

}  // namespace lacuna
