#include "effects/gravity.h"

#include <gtest/gtest.h>

#include "effects/catalogue.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

TEST(Gravity, PassesTheEffectChecks) {
  const auto gravity = MakeEffect(
      "gravity", {{"acceleration_x", 1}, {"acceleration_y", -2}, {"acceleration_z", -9.81}});
  CheckEffect(gravity.get(), {.depends_on_position = false});
}

TEST(Gravity, PullsWithTheWeightOfTheBody) {
  const auto gravity = MakeEffect("gravity", {{"acceleration_z", -9.81}});
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.03, 0.03}, {3, 1, 1}, order), 1070);
    const Eigen::VectorXd position = body.mesh.nodes.reshaped();
    const Eigen::VectorXd velocity = Eigen::VectorXd::Zero(position.size()), state;
    Eigen::VectorXd force = Eigen::VectorXd::Zero(position.size());
    gravity->AddForce({body, position, velocity, velocity, 0, 0, state}, &force);
    // 1070 kg/m³ × 90 cm³ × 9.81 m/s²
    EXPECT_NEAR(force.reshaped(3, body.NodeCount()).row(2).sum(), -1070 * 9e-5 * 9.81, 1e-12);
    EXPECT_EQ(force.reshaped(3, body.NodeCount()).topRows(2).norm(), 0);
  }
}

TEST(Gravity, IsFoundByItsTypeAmongTheEffectsOfAModel) {
  const auto damping = MakeEffect("mass_damping", {{"alpha", 1}});
  EXPECT_FALSE(GravityOf({damping}).has_value());
  const auto gravity = MakeGravity({1, -2, -9});
  EXPECT_EQ(gravity->Card().type, "gravity");
  EXPECT_EQ(GravityOf({damping, gravity}).value(), Eigen::Vector3d(1, -2, -9));
}

}  // namespace
}  // namespace lacuna
