// The derivatives of an effect by position, velocity and acceleration.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <string>

#include "support/dense_matrix.h"
#include "support/effect_in_motion.h"

namespace lacuna {
namespace {

void CheckTangent(const EffectInMotion& moving, const std::string& name,
                  const TangentWeights& weights, bool depends) {
  const Eigen::MatrixXd tangent = moving.Tangent(weights, false);
  const auto derivative = [&](double h) {
    Eigen::MatrixXd columns(moving.size(), moving.size());
    for (Eigen::Index k = 0; k < moving.size(); ++k) {
      const Eigen::VectorXd shift = h * Eigen::VectorXd::Unit(moving.size(), k);
      columns.col(k) = moving.Force(Shifted(moving.motion(), weights, shift));
    }
    return columns;
  };
  if (!depends) {
    EXPECT_EQ(tangent.norm(), 0) << "∂f/∂" << name << " was said to be zero";
    EXPECT_TRUE(moving.SkewTangent(weights).isZero(0)) << "the skew part of ∂f/∂" << name;
    EXPECT_EQ((derivative(1e-4) - derivative(-1e-4)).norm(), 0) << "∂f/∂" << name;
    return;
  }
  ASSERT_GT(tangent.norm(), 0) << "∂f/∂" << name << " is zero";
  EXPECT_LT((tangent - tangent.transpose()).norm(), 1e-13 * tangent.norm());
  const Eigen::MatrixXd skew = moving.SkewTangent(weights);
  EXPECT_LE((skew + skew.transpose()).norm(), 1e-13 * tangent.norm());
  const double unit = weights.position == 0 ? 1 : 0.01;  // m/s, m/s² or m
  EXPECT_LT(BestError(derivative, Eigen::MatrixXd(tangent + skew), unit),
            moving.options().tolerance)
      << "∂f/∂" << name;
}

}  // namespace

void CheckTangents(const EffectInMotion& moving) {
  const CheckEffectOptions& options = moving.options();
  CheckTangent(moving, "position", {.position = 1}, options.depends_on_position);
  CheckTangent(moving, "velocity", {.velocity = 1}, options.depends_on_velocity);
  CheckTangent(moving, "acceleration", {.acceleration = 1}, options.depends_on_acceleration);
}

void CheckTangentsAdd(const EffectInMotion& moving) {
  const Effect& effect = moving.effect();
  BlockMatrix twice(moving.body().pattern);
  const Kinematics at = moving.Now();
  effect.AddTangents(at, {.position = 1.5, .acceleration = 2}, false, &twice);
  effect.AddTangents(at, {.velocity = -0.5}, false, &twice);
  const Eigen::MatrixXd sum = 1.5 * moving.Tangent({.position = 1}, false) -
                              0.5 * moving.Tangent({.velocity = 1}, false) +
                              2 * moving.Tangent({.acceleration = 1}, false);
  EXPECT_LE((Dense(twice) - sum).norm(), 1e-13 * sum.norm()) << "tangents add, by their weights";
  BlockMatrix skew(moving.body().pattern);
  effect.AddSkewTangents(at, {.position = 1.5, .acceleration = 2}, &skew);
  effect.AddSkewTangents(at, {.velocity = -0.5}, &skew);
  const Eigen::MatrixXd skew_sum = 1.5 * moving.SkewTangent({.position = 1}) -
                                   0.5 * moving.SkewTangent({.velocity = 1}) +
                                   2 * moving.SkewTangent({.acceleration = 1});
  EXPECT_LE((Dense(skew) - skew_sum).norm(), 1e-13 * sum.norm()) << "and so do skew parts";

  Eigen::VectorXd force = Eigen::VectorXd::Ones(moving.size());
  effect.AddForce(at, &force);
  const Eigen::VectorXd alone = moving.Force();
  EXPECT_LE((force - alone - Eigen::VectorXd::Ones(moving.size())).norm(), 1e-13 * force.norm())
      << "forces add";
}

void CheckDefiniteTangent(const EffectInMotion& moving) {
  const Eigen::MatrixXd tangent = moving.Tangent({1, 1, 1}, true);
  const double largest = tangent.norm();
  EXPECT_LE((tangent - tangent.transpose()).norm(), 1e-13 * largest);
  const Eigen::VectorXd eigenvalues = tangent.selfadjointView<Eigen::Lower>().eigenvalues();
  EXPECT_LE(eigenvalues.maxCoeff(), 1e-12 * largest) << "negative semi-definite";
}

}  // namespace lacuna
