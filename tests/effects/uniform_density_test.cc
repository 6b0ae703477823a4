#include "effects/uniform_density.h"

#include <gtest/gtest.h>

#include <memory>

#include "effects/catalogue.h"
#include "effects/gravity.h"
#include "fem/prediction.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

const Eigen::Vector3d kFall(0, 0, -kStandardGravity);

TEST(UniformDensity, PassesTheEffectChecks) {
  CheckEffect(MakeUniformDensity(1234, {1, 2, -9}).get(),
              {.depends_on_position = false, .depends_on_acceleration = true});
}

TEST(UniformDensity, AddsTheWeightOfTheDifference) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.16, 0.04, 0.04}, {4, 2, 2}, 2), 1000);
  const auto heavier = MakeUniformDensity(1050, kFall);
  EXPECT_TRUE(IsUniformDensity(*heavier));
  EXPECT_FALSE(IsUniformDensity(*MakeGravity(kFall)));
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  const Eigen::Matrix3Xd force =
      ForceAt(*heavier, body, rest, 0 * rest).reshaped(3, body.NodeCount());
  // 5 % of 1000 kg/m³ in 0.16 · 0.04 · 0.04 m³; up to rounding of a sum of nodes.
  EXPECT_LT((force.rowwise().sum() - 50 * 2.56e-4 * kFall).norm(), 1e-12);
  const auto equal = MakeUniformDensity(1000, kFall);
  EXPECT_EQ(ForceAt(*equal, body, rest, 0 * rest).norm(), 0);
}

// The position after 30 ms of a clamped bar that falls from rest in its undeformed shape.
Eigen::VectorXd Fallen(double density, const EffectList& further) {
  const TetMesh mesh = BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {4, 1, 1}, 2);
  Model model;
  model.body = std::make_shared<const Body>(MakeBody(mesh, density));
  model.effects = {MakeEffect("neo_hookean", {{"young_modulus", 5e4}, {"poisson_ratio", 0.4}}),
                   MakeGravity(kFall)};
  model.effects.insert(model.effects.end(), further.begin(), further.end());
  model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 1e-6; }), {}}};
  MotionHistory history = RestHistory(model);
  Stepper stepper(model, {.scheme = TimeScheme::kTwoStep, .relative_tolerance = 1e-10});
  for (int step = 0; step < 30; ++step) EXPECT_TRUE(stepper.Step(1e-3, {}, &history).IsUsable());
  return history.position;
}

TEST(UniformDensity, MovesABodyAsOneOfThatDensityMoves) {
  const Eigen::VectorXd moved = Fallen(1000, {MakeUniformDensity(1400, kFall)});
  const Eigen::VectorXd expected = Fallen(1400, {});
  const double difference = (expected - Fallen(1000, {})).norm();
  EXPECT_GT(difference, 1e-4);
  // The equations are the same; their solutions agree to the tolerance of Newton's method.
  EXPECT_LT((moved - expected).norm(), 1e-5 * difference);
}

TEST(UniformDensity, MayBePutIntoTheBody) {
  const EffectList damped = {MakeEffect("mass_damping", {{"alpha", 14}}),
                             MakeUniformDensity(1400, kFall)};
  EXPECT_EQ(DensityWith(damped, 1000), 1400);
  EXPECT_EQ(DensityWith({damped.front()}, 1000), 1000);
  const EffectList in_body = WithDensityInBody(damped, 1000);
  ASSERT_EQ(in_body.size(), 1u);
  EXPECT_NEAR(in_body.front()->Parameters()[0], 10, 1e-12);  // 14 · 1000/1400, up to rounding
  const Eigen::VectorXd moved = Fallen(1000, damped), expected = Fallen(1400, in_body);
  const double difference = (expected - Fallen(1400, {damped.front()})).norm();
  EXPECT_GT(difference, 1e-5);
  // The equations are the same; their solutions agree to the tolerance of Newton's method.
  EXPECT_LT((moved - expected).norm(), 1e-3 * difference);
}

}  // namespace
}  // namespace lacuna
