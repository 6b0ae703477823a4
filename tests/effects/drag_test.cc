#include <gtest/gtest.h>

#include <cmath>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

TEST(Drag, PassesTheEffectChecks) {
  CheckEffect(MakeEffect("drag", {{"coefficient", 40}, {"linear", 3}}).get(),
              {.depends_on_position = false, .depends_on_velocity = true});
}

TEST(Drag, HasADerivativeAtItsNullValue) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.05, 0.02}, {2, 1, 1}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), state;
  const Eigen::VectorXd velocity = Eigen::Vector3d(3, 0, 4).replicate(body.NodeCount(), 1);
  const auto drag = MakeEffect("drag", {{"coefficient", 0}});
  const Kinematics at{body, rest, velocity, 0 * velocity, 0, 0.01, state};
  Eigen::VectorXd derivative = Eigen::VectorXd::Zero(rest.size());
  drag->AddParameterDerivative(at, 0, &derivative);
  // −(surface 160 cm²) · 5 m/s · (3, 0, 4) m/s
  const Eigen::Vector3d total = derivative.reshaped(3, body.NodeCount()).rowwise().sum();
  EXPECT_LT((total - Eigen::Vector3d(-0.24, 0, -0.32)).norm(), 1e-14);
}

TEST(Drag, IsFiniteAndSmoothAtRest) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.05, 0.02}, {2, 1, 1}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), state;
  const auto drag = MakeEffect("drag", {{"coefficient", 40}});
  for (const double speed : {0.0, 1e-300, 1e-12}) {
    const Eigen::VectorXd velocity = Eigen::VectorXd::Constant(rest.size(), speed);
    BlockMatrix tangent(body.pattern);
    drag->AddTangents({body, rest, velocity, 0 * velocity, 0, 0.01, state}, {.velocity = 1}, false,
                      &tangent);
    for (int k = 0; k < body.pattern->BlockCount(); ++k) {
      // The bound is a few times coefficient · area · speed.
      EXPECT_LE(tangent.Block(k).cwiseAbs().maxCoeff(), 40 * 0.016 * 4 * speed);
    }
  }
}

// A block falls: m v̇ = m g − b S v², so v = V tanh(g t/V) with V = √(m g/(b S)).
TEST(Drag, LetsAFallingBlockApproachItsTerminalVelocity) {
  constexpr double kGravity = 9.81, kDensity = 1000, kCoefficient = 300, kTime = 0.5;
  constexpr double kSurface = 2 * (0.04 * 0.03 + 0.04 * 0.02 + 0.03 * 0.02);
  constexpr double kMass = kDensity * 0.04 * 0.03 * 0.02;
  const double terminal = std::sqrt(kMass * kGravity / (kCoefficient * kSurface));
  for (const int order : {1, 2}) {
    const Model model{std::make_shared<Body>(MakeBody(
                          BoxMesh({0, 0, 0}, {0.04, 0.03, 0.02}, {2, 2, 1}, order), kDensity)),
                      {MakeEffect("corotational", {{"young_modulus", 1e6}, {"poisson_ratio", 0.3}}),
                       MakeEffect("stiffness_damping",
                                  {{"beta", 0.01}, {"young_modulus", 1e6}, {"poisson_ratio", 0.3}}),
                       MakeEffect("gravity", {{"acceleration_z", -kGravity}}),
                       MakeEffect("drag", {{"coefficient", kCoefficient}})},
                      {}};
    MotionHistory history = RestHistory(model);
    Stepper stepper(model, {.scheme = TimeScheme::kBdf2});
    const Eigen::VectorXd& mass = model.body->node_mass;
    const auto mean_velocity = [&] {
      return -history.velocity.reshaped(3, mass.size()).row(2).dot(mass) / mass.sum();
    };
    constexpr int kSteps = 100;
    for (int k = 0; k < kSteps; ++k) {
      const StepSummary step = stepper.Step(kTime / kSteps, {}, &history);
      ASSERT_TRUE(step.IsUsable()) << step.message;
      if (k + 1 != kSteps / 10) continue;
      // During the fall. The step is 1/40 of V/g; errors of second order cause about 0.1 %.
      const double expected = terminal * std::tanh(kGravity * history.time / terminal);
      EXPECT_LT(expected, 0.9 * terminal);
      EXPECT_NEAR(mean_velocity(), expected, 2e-3 * terminal);
    }
    // g t/V = 12.6: within 1e-10 of the limit, and the steps are solved to 1e-8.
    EXPECT_NEAR(mean_velocity(), terminal, 1e-7 * terminal);
  }
}

TEST(Drag, IsReadFromYaml) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: drag, coefficient: 150 kg/m^3, linear: 2 Pa s/m}\n"
      "  - {type: drag, coefficient: -1 kg/m^3}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  EXPECT_EQ(MakeEffect(items[0])->Parameters(), Eigen::Vector2d(150, 2));
  EXPECT_THROW(MakeEffect(items[1]), InputError);
}

}  // namespace
}  // namespace lacuna
