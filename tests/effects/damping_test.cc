#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <random>

#include "effects/catalogue.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

const std::map<std::string, double> kStiffnessDamping{
    {"beta", 0.02}, {"young_modulus", 8e4}, {"poisson_ratio", 0.4}};

TEST(MassDamping, PassesTheEffectChecks) {
  CheckEffect(MakeEffect("mass_damping", {{"alpha", 3}}).get(),
              {.depends_on_position = false, .depends_on_velocity = true});
}

TEST(MassDamping, BrakesByItsRateTimesMomentum) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.03}, {2, 1, 1}), 1000);
  const Eigen::VectorXd position = body.mesh.nodes.reshaped();
  const Eigen::VectorXd velocity = Eigen::Vector3d(2, 0, 0).replicate(body.NodeCount(), 1);
  const Eigen::VectorXd force =
      ForceAt(*MakeEffect("mass_damping", {{"alpha", 3}}), body, position, velocity);
  // −3 /s × 0.09 kg × 2 m/s
  EXPECT_NEAR(force.sum(), -0.54, 1e-13);
}

TEST(StiffnessDamping, PassesTheEffectChecks) {
  CheckEffect(MakeEffect("stiffness_damping", kStiffnessDamping).get(),
              {.depends_on_position = true, .depends_on_velocity = true});
}

TEST(StiffnessDamping, IsBetaTimesTheElasticForceOfTheVelocityAtSmallStrain) {
  const Body body =
      MakeBody(Jittered(BoxMesh({0, 0, 0}, {0.04, 0.02, 0.02}, {2, 1, 1}), 0.02, 0.1, 3), 1000);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  const Eigen::VectorXd velocity =
      Eigen::VectorXd::NullaryExpr(rest.size(), [&] { return uniform(random); });
  const auto linear = MakeEffect("linear", {{"young_modulus", 8e4}, {"poisson_ratio", 0.4}});
  const Eigen::VectorXd elastic = ForceAt(*linear, body, rest + velocity, 0 * velocity);
  const Eigen::VectorXd viscous =
      ForceAt(*MakeEffect("stiffness_damping", kStiffnessDamping), body, rest, velocity);
  EXPECT_LT((viscous - 0.02 * elastic).norm(), 1e-12 * viscous.norm());
}

TEST(StiffnessDamping, NeverAddsEnergy) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.04, 0.02, 0.02}, {2, 1, 1}), 1000);
  const auto damping = MakeEffect("stiffness_damping", kStiffnessDamping);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped();
  for (int trial = 0; trial < 100; ++trial) {
    // The largest of these deformations invert elements.
    const Eigen::VectorXd position =
        rest + 0.02 * Eigen::VectorXd::NullaryExpr(rest.size(), [&] { return uniform(random); });
    const Eigen::VectorXd velocity =
        Eigen::VectorXd::NullaryExpr(rest.size(), [&] { return uniform(random); });
    EXPECT_LT(ForceAt(*damping, body, position, velocity).dot(velocity), 0);
  }
}

}  // namespace
}  // namespace lacuna
