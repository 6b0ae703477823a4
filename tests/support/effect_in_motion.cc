#include "support/effect_in_motion.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "support/box_mesh.h"
#include "support/dense_matrix.h"

namespace lacuna {

MovingBody MakeMovingBody(const Effect& effect, int order, const std::array<int, 3>& cells,
                          const CheckEffectOptions& options) {
  constexpr double kCell = 0.02;  // m
  std::mt19937 random(options.seed);
  const Eigen::Vector3d low(0.01, -0.03, 0.02);
  TetMesh mesh = BoxMesh(low, low + kCell * Eigen::Vector3d(cells[0], cells[1], cells[2]), cells);
  mesh = Jittered(mesh, kCell, 0.15, options.seed);
  MovingBody moving{.body = MakeBody(order == 1 ? mesh : ToQuadratic(mesh), 1100)};
  const Eigen::Index size = 3 * moving.body.NodeCount();
  const Eigen::Matrix3d rotation =
      Eigen::AngleAxisd(1.0, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  Eigen::Matrix3Xd nodes = moving.body.mesh.nodes;
  // Nodes of quadratic elements are half as far apart.
  nodes.reshaped() += 0.25 * options.strain * kCell / order * RandomVector(size, &random);
  nodes = (rotation * nodes).colwise() + Eigen::Vector3d(0.05, -0.02, 0.01);
  Motion& motion = moving.motion;
  motion.position = nodes.reshaped();
  motion.velocity = 0.25 * options.strain_rate * kCell / order * RandomVector(size, &random);
  motion.acceleration = 10 * RandomVector(size, &random);
  moving.state.resize(effect.StateSize(moving.body));
  effect.InitialState(moving.body, &moving.state);
  const Eigen::VectorXd before =
      motion.position + 0.25 * options.strain * kCell / order * RandomVector(size, &random);
  const Eigen::VectorXd at_rest = moving.state;
  effect.AdvanceState({moving.body, before, motion.velocity, motion.acceleration,
                       options.time - options.time_step, options.time_step, at_rest},
                      &moving.state);
  return moving;
}

Eigen::VectorXd RandomVector(Eigen::Index size, std::mt19937* random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  return Eigen::VectorXd::NullaryExpr(size, [&] { return uniform(*random); });
}

Motion Shifted(const Motion& motion, const TangentWeights& by, const Eigen::VectorXd& shift) {
  return {motion.position + by.position * shift, motion.velocity + by.velocity * shift,
          motion.acceleration + by.acceleration * shift};
}

EffectInMotion::EffectInMotion(const Effect& effect, int order, const CheckEffectOptions& options)
    : effect_(effect),
      options_(options),
      order_(order),
      moving_(MakeMovingBody(effect, order, {2, 1, 2}, options)) {}

Kinematics EffectInMotion::At(const Motion& motion, bool has_inertia) const {
  return {moving_.body,        motion.position,     motion.velocity,
          motion.acceleration, options_.time,       options_.time_step,
          moving_.state,       options_.elasticity, has_inertia};
}

Eigen::VectorXd EffectInMotion::Force(const Motion& motion, bool has_inertia) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(size());
  effect_.AddForce(At(motion, has_inertia), &force);
  return force;
}

Eigen::VectorXd EffectInMotion::ForceWith(const Eigen::VectorXd& values) const {
  Eigen::VectorXd force = Eigen::VectorXd::Zero(size());
  effect_.WithParameters(values)->AddForce(Now(), &force);
  return force;
}

Eigen::MatrixXd EffectInMotion::Tangent(const TangentWeights& weights, bool convexify) const {
  BlockMatrix tangent(moving_.body.pattern);
  effect_.AddTangents(Now(), weights, convexify, &tangent);
  return Dense(tangent);
}

Eigen::MatrixXd EffectInMotion::SkewTangent(const TangentWeights& weights) const {
  BlockMatrix tangent(moving_.body.pattern);
  const bool any = effect_.AddSkewTangents(Now(), weights, &tangent);
  const Eigen::MatrixXd dense = Dense(tangent);
  EXPECT_TRUE(any || dense.isZero(0)) << "a skew part that was said not to be there";
  return dense;
}

}  // namespace lacuna
