#include <gtest/gtest.h>

#include <vector>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

std::map<std::string, double> ForceAtTheTop(double radius) {
  return {{"force_x", 0.2},   {"force_y", -1},    {"force_z", 3},
          {"centre_x", 0.04}, {"centre_y", 0.02}, {"centre_z", 0.0401},
          {"radius", radius}, {"start", 0.295},   {"stop", 0.42}};
}

TEST(PointForce, PassesTheEffectChecks) {
  CheckEffect(MakeEffect("point_force", ForceAtTheTop(0.01)).get(), {.depends_on_position = false});
}

TEST(PointForce, ActsOnTheSurfaceAboutItsPlace) {
  const auto effect = MakeEffect("point_force", ForceAtTheTop(0.005));
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.04, 0.04}, {8, 4, 4}, order), 1000);
    const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), zero = 0 * rest, state;
    Eigen::VectorXd force = zero;
    effect->AddForce({body, rest, zero, zero, 0.4, 0.01, state}, &force);
    const Eigen::Matrix3Xd nodal = force.reshaped(3, body.NodeCount());
    EXPECT_LT((nodal.rowwise().sum() - Eigen::Vector3d(0.2, -1, 3)).norm(), 1e-13);
    const Eigen::VectorXd areas = NodeBoundaryAreas(body);
    for (int i = 0; i < body.NodeCount(); ++i) {
      if (areas[i] == 0) {
        EXPECT_EQ(nodal.col(i).norm(), 0);
      }
    }
    const Eigen::Vector3d place = body.mesh.nodes * nodal.row(2).transpose() / 3;
    // The face ends 4 standard deviations away; less than 1e-3 of the force is on other faces.
    EXPECT_LT((place - Eigen::Vector3d(0.04, 0.02, 0.04)).norm(), 1e-4);
  }
}

TEST(PointForce, FollowsItsSettingsAndTheBody) {
  const auto effect = MakeEffect("point_force", ForceAtTheTop(0.005));
  const Body coarse = MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.04, 0.04}, {8, 4, 4}), 1000);
  const Body fine = MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.04, 0.04}, {16, 8, 8}), 1000);
  const auto place = [](const Effect& force_on, const Body& body) {
    const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), zero = 0 * rest, state;
    Eigen::VectorXd force = zero;
    force_on.AddForce({body, rest, zero, zero, 0.4, 0.01, state}, &force);
    const Eigen::Matrix3Xd nodal = force.reshaped(3, body.NodeCount());
    return Eigen::Vector3d(body.mesh.nodes * nodal.row(2).transpose() / 3);
  };
  // Less than 1e-3 of the force is on other faces.
  EXPECT_LT((place(*effect, coarse) - Eigen::Vector3d(0.04, 0.02, 0.04)).norm(), 1e-4);
  EXPECT_LT((place(*effect, fine) - Eigen::Vector3d(0.04, 0.02, 0.04)).norm(), 1e-4);
  Eigen::VectorXd moved = effect->Parameters();
  moved[3] = 0.05;
  const auto other = effect->WithParameters(moved);
  EXPECT_LT((place(*other, fine) - Eigen::Vector3d(0.05, 0.02, 0.04)).norm(), 1e-4);
  EXPECT_LT((place(*other, coarse) - Eigen::Vector3d(0.05, 0.02, 0.04)).norm(), 1e-4);
}

// A free body gets the momentum F (stop − start), also for steps that do not end at start and stop.
TEST(PointForce, GivesItsImpulse) {
  const Model model{
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.04, 0.04}, {2, 1, 1}), 1000)),
      {MakeEffect("corotational", {{"young_modulus", 1e6}, {"poisson_ratio", 0.3}}),
       MakeEffect("point_force", ForceAtTheTop(0.02))},
      {}};
  MotionHistory history = RestHistory(model);
  Stepper stepper(model, {.scheme = TimeScheme::kImplicitEuler});
  for (int k = 0; k < 16; ++k) {
    const StepSummary step = stepper.Step(0.03, {}, &history);
    ASSERT_TRUE(step.IsUsable()) << step.message;
    if (history.time < 0.295) {
      EXPECT_EQ(history.velocity.norm(), 0);
    }
  }
  const Eigen::Vector3d momentum =
      history.velocity.reshaped(3, model.body->NodeCount()) * model.body->node_mass;
  const Eigen::Vector3d impulse = (0.42 - 0.295) * Eigen::Vector3d(0.2, -1, 3);
  // Implicit Euler keeps momentum; the steps are solved to 1e-8.
  EXPECT_LT((momentum - impulse).norm(), 1e-6 * impulse.norm());
}

// An equilibrium carries the whole force, also at the end of a step that began before the force
// did. Ten steps of 0.1 s end at 1 s up to rounding.
TEST(PointForce, DoesNotDependOnTheLengthOfQuasiStaticSteps) {
  std::map<std::string, double> values = ForceAtTheTop(0.02);
  values["start"] = 1;
  values["stop"] = 3;
  Model model{
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.04, 0.04}, {2, 1, 1}), 1000)),
      {MakeEffect("corotational", {{"young_modulus", 1e6}, {"poisson_ratio", 0.3}}),
       MakeEffect("point_force", values)},
      {}};
  model.grips = {
      {NodesWhere(model.body->mesh, [](const Eigen::Vector3d& X) { return X.x() < 1e-9; }), {}}};
  const Eigen::VectorXd rest = model.body->mesh.nodes.reshaped();
  const auto displacement = [&](const std::vector<double>& steps) {
    Stepper stepper(model, {.scheme = TimeScheme::kQuasiStatic});
    MotionHistory history = RestHistory(model);
    for (const double length : steps) {
      const StepSummary step = stepper.Step(length, {}, &history);
      EXPECT_TRUE(step.IsUsable()) << step.message;
    }
    return Eigen::VectorXd(history.position - rest);
  };
  MotionHistory held = RestHistory(model);
  held.time = 2;
  ASSERT_TRUE(Stepper(model, {}).Equilibrium({}, &held).IsUsable());
  const Eigen::VectorXd expected = held.position - rest;
  ASSERT_GT(expected.norm(), 0);
  const std::vector<std::vector<double>> paths{
      {2}, {1.5, 0.5}, {0.5, 1}, std::vector<double>(10, 0.1)};
  for (const std::vector<double>& steps : paths) {
    // Each step is solved to 1e-8 of its forces.
    EXPECT_LT((displacement(steps) - expected).norm(), 1e-6 * expected.norm()) << steps.size();
  }
  EXPECT_LT(displacement({0.5}).norm(), 1e-9 * expected.norm()) << "before the start";
}

TEST(PointForce, ActsInStaticsFromStartAndNotAtStop) {
  const auto effect = MakeEffect("point_force", ForceAtTheTop(0.02));
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.04, 0.04}, {2, 1, 1}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), zero = 0 * rest, state;
  for (const double step : {0.0, 0.2}) {  // quasi-static steps have a length
    const auto size = [&](double time) {
      Eigen::VectorXd force = zero;
      effect->AddForce({body, rest, zero, zero, time, step, state}, &force);
      return force.norm();
    };
    EXPECT_EQ(size(0.29), 0);
    EXPECT_GT(size(0.295), 0);
    EXPECT_EQ(size(0.42), 0);
  }
}

TEST(PointForce, IsReadFromYaml) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: point_force, force: [0, 0, -2 N], centre: [1 cm, 0, 0], start: 10 ms}\n"
      "  - {type: point_force, force: [0, 0, -2 N], centre: [1 cm, 0, 0], start: 3 s, stop: 3 s}\n"
      "  - {type: point_force, force: [0, 0, -2 N]}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  Eigen::VectorXd expected(9);
  expected << 0, 0, -2, 0.01, 0, 0, 0.005, 0.01, 1e12;
  EXPECT_LT((MakeEffect(items[0])->Parameters() - expected).norm(), 1e-12);
  EXPECT_THROW(MakeEffect(items[1]), InputError);
  EXPECT_THROW(MakeEffect(items[2]), InputError);
}

}  // namespace
}  // namespace lacuna
