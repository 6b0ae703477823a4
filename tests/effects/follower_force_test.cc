#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <vector>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

TEST(FollowerForce, PassesTheEffectChecks) {
  CheckEffect(MakeEffect("follower_force", {{"force_x", 0.2},
                                            {"force_y", -1},
                                            {"force_z", 3},
                                            {"centre_x", 0.03},
                                            {"centre_y", -0.02},
                                            {"centre_z", 0.04},
                                            {"radius", 0.015}})
                  .get());
}

TEST(FollowerForce, RotatesWithTheBody) {
  const auto effect = MakeEffect("follower_force", {{"force_x", 0.2},
                                                    {"force_y", -1},
                                                    {"force_z", 3},
                                                    {"centre_x", 0.04},
                                                    {"centre_y", 0.02},
                                                    {"centre_z", 0.02},
                                                    {"radius", 0.005}});
  const Eigen::Matrix3d turn =
      Eigen::AngleAxisd(2.5, Eigen::Vector3d(1, 2, -1).normalized()).toRotationMatrix();
  const Eigen::Matrix3d stretch = Eigen::Vector3d(1.4, 0.8, 1.1).asDiagonal();
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.04, 0.04}, {16, 8, 8}, order), 1000);
    const Eigen::VectorXd position = (turn * stretch * body.mesh.nodes).reshaped();
    const Eigen::Matrix3Xd force =
        ForceAt(*effect, body, position, 0 * position).reshaped(3, body.NodeCount());
    const Eigen::Vector3d expected = turn * Eigen::Vector3d(0.2, -1, 3);
    EXPECT_LT((force.rowwise().sum() - expected).norm(), 1e-12);
    // The distribution and the mesh are symmetric about its centre.
    const Eigen::Vector3d place =
        body.mesh.nodes * (expected.transpose() * force).transpose() / expected.squaredNorm();
    EXPECT_LT((place - Eigen::Vector3d(0.04, 0.02, 0.02)).norm(), 1e-6);
  }
}

TEST(FollowerForce, IsFiniteWhereElementsAreFlatOrInverted) {
  const auto effect = MakeEffect("follower_force", {{"force_x", 0.2},
                                                    {"force_y", -1},
                                                    {"force_z", 3},
                                                    {"centre_x", 0.04},
                                                    {"centre_y", 0.02},
                                                    {"centre_z", 0.02},
                                                    {"radius", 0.01}});
  const double full = Eigen::Vector3d(0.2, -1, 3).norm();
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.04, 0.04}, {4, 2, 2}, order), 1000);
    for (const double squeeze : {0.0, -0.5, -1.0}) {
      const Eigen::VectorXd position =
          (Eigen::Vector3d(1, 1, squeeze).asDiagonal() * body.mesh.nodes).reshaped();
      const Eigen::VectorXd zero = 0 * position, state;
      const Eigen::VectorXd force = ForceAt(*effect, body, position, zero);
      EXPECT_TRUE(force.allFinite());
      // A mirrored element has two nearest rotations, and its neighbours may take the other.
      const double total = force.reshaped(3, body.NodeCount()).rowwise().sum().norm();
      EXPECT_LE(total, full * (1 + 1e-12));
      if (squeeze > -1) {
        EXPECT_GE(total, full * (1 - 1e-12));
      }
      BlockMatrix tangent(body.pattern);
      effect->AddTangents({body, position, zero, zero, 0, 0, state}, {.position = 1}, false,
                          &tangent);
      for (int k = 0; k < body.pattern->BlockCount(); ++k) {
        EXPECT_TRUE(tangent.Block(k).allFinite());
      }
    }
  }
}

// A stiff bar on a hinge at its lower end, pushed at its upper end by a force that rotates with it:
// the torque F L is constant, so that the angle grows as ½ F L t²/I beyond 90°, where the torque of
// a force of fixed direction would vanish.
TEST(FollowerForce, KeepsItsTorqueAsTheBarRotates) {
  constexpr double kForce = 0.4, kLever = 0.075, kTime = 0.16;
  const auto body = std::make_shared<Body>(
      MakeBody(BoxMesh({-0.01, -0.01, 0}, {0.01, 0.01, 0.1}, {2, 1, 4}), 1000));
  const Model model{
      body,
      {MakeEffect("corotational", {{"young_modulus", 1e7}, {"poisson_ratio", 0.3}}),
       MakeEffect("stiffness_damping",
                  {{"beta", 1e-3}, {"young_modulus", 1e7}, {"poisson_ratio", 0.3}}),
       MakeEffect("follower_force", {{"force_x", kForce},
                                     {"force_y", 0},
                                     {"force_z", 0},
                                     {"centre_x", 0},
                                     {"centre_y", 0},
                                     {"centre_z", kLever},
                                     {"radius", 0.004}})},
      {{NodesWhere(body->mesh,
                   [](const Eigen::Vector3d& X) { return std::abs(X.x()) < 1e-9 && X.z() < 1e-9; }),
        {}}}};
  double inertia = 0;
  for (int i = 0; i < body->NodeCount(); ++i) {
    const Eigen::Vector3d X = body->mesh.nodes.col(i);
    inertia += body->node_mass[i] * (X.x() * X.x() + X.z() * X.z());
  }
  MotionHistory history = RestHistory(model);
  Stepper stepper(model, {.scheme = TimeScheme::kBdf2});
  constexpr int kSteps = 100;
  for (int k = 0; k < kSteps; ++k) {
    const StepSummary step = stepper.Step(kTime / kSteps, {}, &history);
    ASSERT_TRUE(step.IsUsable()) << step.message;
  }
  const Eigen::Vector3d centre =
      history.position.reshaped(3, body->NodeCount()) * body->node_mass / body->node_mass.sum();
  const double angle = std::atan2(centre.x(), centre.z());
  const double expected = 0.5 * kForce * kLever * kTime * kTime / inertia;
  EXPECT_GT(expected, 0.6 * std::numbers::pi);
  // The quadrature points represent the centre of the force to within 1 % of the lever.
  EXPECT_NEAR(angle, expected, 0.01 * expected);
}

// The rotation of the loaded end of an elastica of length L, clamped at the other, under a force F
// that stays perpendicular to it there. With s from the loaded end and φ the rotation relative to
// it, EI φ'' = F cos φ, φ(0) = φ'(0) = 0 (Bolotin, Nonconservative Problems, 1963).
double FollowedRotation(double force_over_stiffness, double length) {
  constexpr int kSteps = 2000;
  const double h = length / kSteps;
  double angle = 0, curvature = 0;
  for (int k = 0; k < kSteps; ++k) {  // the midpoint rule
    const double middle = angle + 0.5 * h * curvature;
    angle += h * (curvature + 0.5 * h * force_over_stiffness * std::cos(angle));
    curvature += h * force_over_stiffness * std::cos(middle);
  }
  return angle;
}

// The force does work on a closed path, and its tangent is far from symmetric at such a rotation.
TEST(FollowerForce, HoldsABeamThatIsBentByMoreThanARightAngle) {
  constexpr double kModulus = 1e6, kSide = 5e-3, kLength = 0.095;
  const double stiffness = kModulus * std::pow(kSide, 4) / 12;
  const double force = 4 * stiffness / (kLength * kLength);
  const auto body = std::make_shared<Body>(MakeBody(
      BoxMesh({0, -kSide / 2, -kSide / 2}, {0.1, kSide / 2, kSide / 2}, {20, 1, 1}, 2), 1000));
  const Model model{
      body,
      {MakeEffect("corotational", {{"young_modulus", kModulus}, {"poisson_ratio", 0.3}}),
       MakeEffect("follower_force", {{"force_x", 0},
                                     {"force_y", force},
                                     {"force_z", 0},
                                     {"centre_x", kLength},
                                     {"centre_y", 0},
                                     {"centre_z", 0},
                                     {"radius", 0.002}})},
      {{NodesWhere(body->mesh, [](const Eigen::Vector3d& X) { return X.x() < 1e-9; }), {}}}};
  MotionHistory history = RestHistory(model);
  const StepSummary summary = Stepper(model, {}).Equilibrium({}, &history);
  ASSERT_TRUE(summary.IsUsable()) << summary.message;
  const auto centre_at = [&](double x) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    const Eigen::VectorXi nodes = NodesWhere(
        body->mesh, [&](const Eigen::Vector3d& X) { return std::abs(X.x() - x) < 1e-9; });
    for (const int node : nodes) sum += history.position.segment<3>(3 * node);
    return Eigen::Vector3d(sum / static_cast<double>(nodes.size()));
  };
  const Eigen::Vector3d tangent = centre_at(0.1) - centre_at(0.095);
  const double expected = FollowedRotation(force / stiffness, kLength);
  EXPECT_GT(expected, 0.5 * std::numbers::pi);
  EXPECT_NEAR(std::atan2(tangent.y(), tangent.x()), expected, 0.03 * expected);
}

TEST(FollowerForce, IsReadFromYaml) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: follower_force, force: [0, 0, -2 N], centre: [1 cm, 0, 0], radius: 3 mm}\n"
      "  - {type: follower_force, force: [0, 0, -2 N]}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  Eigen::VectorXd expected(7);
  expected << 0, 0, -2, 0.01, 0, 0, 0.003;
  EXPECT_LT((MakeEffect(items[0])->Parameters() - expected).norm(), 1e-12);
  EXPECT_THROW(MakeEffect(items[1]), InputError);
}

}  // namespace
}  // namespace lacuna
