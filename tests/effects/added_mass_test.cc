#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

constexpr double kGravity = 9.80665;  // m/s²

// The effect in a model whose gravity is along −z, unless the values contain another one.
std::shared_ptr<const Effect> MakeFalling(const std::string& type,
                                          std::map<std::string, double> values) {
  values.insert({{"gravity_x", 0}, {"gravity_y", 0}, {"gravity_z", -kGravity}});
  return MakeEffect(type, values);
}

// ∂f/∂(first parameter) on the body at rest under a uniform acceleration, 3 × n.
Eigen::Matrix3Xd ForcePerUnit(const Effect& effect, const Body& body,
                              const Eigen::Vector3d& acceleration) {
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), zero = 0 * rest, state;
  const Eigen::VectorXd accelerations = acceleration.replicate(body.NodeCount(), 1);
  Eigen::VectorXd force = zero;
  effect.AddParameterDerivative({body, rest, zero, accelerations, 0, 0.01, state}, 0, &force);
  return force.reshaped(3, body.NodeCount());
}

TEST(AttachedMass, PassesTheEffectChecks) {
  CheckEffect(MakeFalling("attached_mass", {{"mass", 0.02},
                                            {"centre_x", 0.02},
                                            {"centre_y", -0.02},
                                            {"centre_z", 0.03},
                                            {"radius", 0.015},
                                            {"gravity_x", 1}})
                  .get(),
              {.depends_on_position = false, .depends_on_acceleration = true});
}

TEST(AttachedMass, HasItsWeightAndItsInertiaAtItsPlace) {
  const Eigen::Vector3d centre(0.08, 0.02, 0.02);
  // The model has no mass yet, so only the derivative is tested.
  const auto mass = MakeFalling(
      "attached_mass",
      {{"mass", 0}, {"centre_x", 0.08}, {"centre_y", 0.02}, {"centre_z", 0.02}, {"radius", 0.006}});
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.16, 0.04, 0.04}, {16, 4, 4}, order), 1000);
    const Eigen::Matrix3Xd force = ForcePerUnit(*mass, body, {3, 0, 0});
    EXPECT_LT((force.rowwise().sum() - Eigen::Vector3d(-3, 0, -kGravity)).norm(), 1e-12);
    const Eigen::Vector3d place = body.mesh.nodes * force.row(2).transpose() / -kGravity;
    // The distribution is symmetric about its centre, and so are the nodal volumes of a mesh whose
    // cells are all divided along one diagonal.
    EXPECT_LT((place - centre).norm(), 1e-6);
    EXPECT_LT(ForcePerUnit(*mass, body, {0, 0, -kGravity}).norm(), 1e-15) << "falls freely";
  }
}

TEST(AttachedMass, FallsOnTheNearestNodeWhenItIsSmall) {
  const auto mass = MakeFalling(
      "attached_mass",
      {{"mass", 1}, {"centre_x", 0.3}, {"centre_y", 0.041}, {"centre_z", -0.01}, {"radius", 1e-6}});
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.16, 0.04, 0.04}, {2, 2, 2}), 1000);
  const Eigen::Matrix3Xd force = ForcePerUnit(*mass, body, {0, 0, 0});
  const Eigen::VectorXi nodes = NodesWhere(body.mesh, [](const Eigen::Vector3d& X) {
    return (X - Eigen::Vector3d(0.16, 0.04, 0)).norm() < 1e-9;
  });
  ASSERT_EQ(nodes.size(), 1);
  EXPECT_NEAR(force(2, nodes[0]), -kGravity, 1e-12);
}

// Half the period of small oscillations of a rod about a hinge at its upper end, from the first
// passage of the deflected rod through its lowest position.
double HalfPeriod(const Model& model, const Eigen::Vector3d& hinge, double expected) {
  MotionHistory history = RestHistory(model);
  const int nodes = model.body->NodeCount();
  constexpr double kSwing = 0.04;  // rad; lengthens the period by kSwing²/16 = 1e-4
  const double spin = kSwing * std::numbers::pi / expected;
  history.velocity =
      Eigen::MatrixXd((Eigen::Matrix3d() << 0, 0, spin, 0, 0, 0, -spin, 0, 0).finished() *
                      (model.body->mesh.nodes.colwise() - hinge))
          .reshaped();
  const Eigen::VectorXd& mass = model.body->node_mass;
  const auto swing = [&] {
    const Eigen::Matrix3Xd shift = history.position.reshaped(3, nodes) - model.body->mesh.nodes;
    return shift.row(0).dot(mass);
  };
  Stepper stepper(model, {.scheme = TimeScheme::kBdf2});
  // The time step causes a relative error of the period of (π/120)²/3 = 2e-4.
  const double time_step = expected / 120;
  double before = 0;
  for (int k = 0; k < 160; ++k) {
    const StepSummary step = stepper.Step(time_step, {}, &history);
    EXPECT_TRUE(step.IsUsable()) << step.message;
    if (!step.IsUsable()) break;
    const double now = swing();
    if (k > 60 && now * before <= 0) {
      return history.time - time_step * now / (now - before);
    }
    before = now;
  }
  return 0;
}

// A stiff rod swings about a hinge: T = 2π √(I/(g Σ m d)), with the moment of inertia I about the
// hinge and the depths d below it.
TEST(AttachedMass, LengthensThePeriodOfAPendulum) {
  const auto body = std::make_shared<Body>(
      MakeBody(BoxMesh({-0.01, -0.01, -0.2}, {0.01, 0.01, 0}, {2, 1, 8}), 1000));
  const Eigen::Vector3d hinge(0, 0, 0), place(0, 0.01, -0.05);
  const auto attached = [&](double mass) {
    return MakeFalling("attached_mass", {{"mass", mass},
                                         {"centre_x", place.x()},
                                         {"centre_y", place.y()},
                                         {"centre_z", place.z()},
                                         {"radius", 1e-4}});
  };
  const Eigen::VectorXi pinned = NodesWhere(
      body->mesh, [](const Eigen::Vector3d& X) { return std::abs(X.x()) < 1e-9 && X.z() > -1e-9; });
  for (const double mass : {0.0, 0.3}) {
    double inertia = mass * place.z() * place.z(), lever = -mass * place.z();
    for (int i = 0; i < body->NodeCount(); ++i) {
      const Eigen::Vector3d X = body->mesh.nodes.col(i);
      inertia += body->node_mass[i] * (X.x() * X.x() + X.z() * X.z());
      lever -= body->node_mass[i] * X.z();
    }
    const double expected = std::numbers::pi * std::sqrt(inertia / (kGravity * lever));
    const Model model{body,
                      {MakeEffect("corotational", {{"young_modulus", 1e8}, {"poisson_ratio", 0.3}}),
                       MakeEffect("gravity", {{"acceleration_z", -kGravity}}), attached(mass)},
                      {{pinned, {}}}};
    // In addition to the error of the step, the rod bends a little (its stiffness is 1e4 times that
    // of the oscillation). With the weight or the inertia of the mass alone the period would be
    // wrong by 20 % or more.
    EXPECT_NEAR(HalfPeriod(model, hinge, expected), expected, 1e-3 * expected) << mass;
  }
}

// The weight has a potential where there is no inertia, in steps with a length, too.
TEST(AttachedMass, HasItsPotentialInEveryEquilibrium) {
  const auto mass = MakeFalling(
      "attached_mass", {{"mass", 0.1}, {"centre_x", 0.08}, {"centre_y", 0}, {"centre_z", 0}});
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.16, 0.04, 0.04}, {2, 1, 1}), 1000);
  const Eigen::VectorXd rest = body.mesh.nodes.reshaped(), zero = 0 * rest, state;
  const Eigen::VectorXd raised = rest + Eigen::Vector3d(0, 0, 0.01).replicate(body.NodeCount(), 1);
  for (const double step : {0.0, 0.3}) {
    const auto energy = [&](bool has_inertia) {
      return mass->Energy({body, raised, zero, zero, 0, step, state, nullptr, has_inertia});
    };
    ASSERT_TRUE(energy(false).has_value()) << step;
    EXPECT_NEAR(*energy(false), 0.1 * kGravity * 0.01, 1e-12);
    EXPECT_FALSE(energy(true).has_value());
  }
}

TEST(DensityGradient, PassesTheEffectChecks) {
  CheckEffect(MakeFalling("density_gradient", {{"gradient", 3000},
                                               {"axis_x", 1},
                                               {"axis_y", -2},
                                               {"axis_z", 0.5},
                                               {"origin_x", 0.02},
                                               {"gravity_y", 2}})
                  .get(),
              {.depends_on_position = false, .depends_on_acceleration = true});
}

TEST(DensityGradient, AddsItsMassAndMovesItsCentre) {
  for (const int order : {1, 2}) {
    const Body body =
        MakeBody(Jittered(BoxMesh({0, 0, 0}, {0.1, 0.04, 0.04}, {10, 2, 2}), 0.01, 0.2, 4), 1000);
    const TetMesh mesh = order == 1 ? body.mesh : ToQuadratic(body.mesh);
    const Body same = MakeBody(mesh, 700);
    const auto from_end =
        MakeFalling("density_gradient", {{"gradient", 0}, {"axis_x", 7}, {"axis_z", 0}});
    const auto from_centre = MakeFalling(
        "density_gradient", {{"gradient", 0}, {"axis_x", 7}, {"axis_z", 0}, {"origin_x", 0.05}});
    // ∫ X dV = 160 cm³ · 5 cm, exactly for any mesh.
    const double moment = 0.1 * 0.04 * 0.04 * 0.05;
    for (const Body* each : {&body, &same}) {
      const Eigen::Matrix3Xd force = ForcePerUnit(*from_end, *each, {2, 0, 0});
      EXPECT_LT((force.rowwise().sum() - moment * Eigen::Vector3d(-2, 0, -kGravity)).norm(),
                1e-12 * moment);
    }
    const Eigen::Matrix3Xd force = ForcePerUnit(*from_centre, same, {0, 0, 0});
    EXPECT_LT(force.rowwise().sum().norm(), 1e-12 * moment);
    // ∫ X (X − X₀) dV = A L³/12. Lumping causes an error of the second moments of the elements, a
    // share of about 1/n² for n elements along the axis.
    const double second = 0.04 * 0.04 * 1e-3 / 12;
    EXPECT_NEAR(-force.row(2).dot(same.mesh.nodes.row(0)) / kGravity, second, 0.03 * second);
  }
}

// A bar hangs by its upper end. N(z) = A g ρ′ z²/2 from its lower end, so that the end sinks by
// g ρ′ L³/(6 E).
TEST(DensityGradient, StretchesAHangingBar) {
  constexpr double kLength = 0.2, kYoung = 1e5, kPerLength = 400;
  const double expected = kGravity * kPerLength * std::pow(kLength, 3) / (6 * kYoung);
  for (const int order : {1, 2}) {
    const Model model{
        std::make_shared<Body>(
            MakeBody(BoxMesh({0, 0, 0}, {0.02, 0.02, kLength}, {1, 1, 16 / order}, order), 1000)),
        {MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", 0}}),
         MakeFalling("density_gradient", {{"gradient", kPerLength}})},
        {}};
    Model held = model;
    held.grips.push_back(
        {NodesWhere(model.body->mesh,
                    [](const Eigen::Vector3d& X) { return X.z() > kLength - 1e-9; }),
         {}});
    MotionHistory history = RestHistory(held);
    const StepSummary summary = Stepper(held, {}).Equilibrium({}, &history);
    ASSERT_TRUE(summary.IsUsable()) << summary.message;
    const Eigen::Matrix3Xd shift =
        history.position.reshaped(3, model.body->NodeCount()) - model.body->mesh.nodes;
    double sunk = 0;
    const Eigen::VectorXi lower =
        NodesWhere(model.body->mesh, [](const Eigen::Vector3d& X) { return X.z() < 1e-9; });
    for (const int node : lower) sunk -= shift(2, node) / static_cast<double>(lower.size());
    // The lumped load lacks a share of 1/n², 0.4 % with n = 16 rows of nodes.
    EXPECT_NEAR(sunk, expected, 0.005 * expected) << order;
  }
}

// The density at the ends would be 1000 ± 5000 kg/m³.
TEST(DensityGradient, CannotMakeADensityNegative) {
  const Model model{
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.02, 0.02}, {5, 1, 1}), 1000)),
      {MakeEffect("linear", {{"young_modulus", 1e5}, {"poisson_ratio", 0}}),
       MakeFalling("density_gradient",
                   {{"gradient", 1e5}, {"axis_x", 1}, {"axis_z", 0}, {"origin_x", 0.05}})},
      {}};
  MotionHistory history = RestHistory(model);
  const StepSummary summary = Stepper(model, {}).Step(0.01, {}, &history);
  EXPECT_EQ(summary.status, StepSummary::Status::kMissingMass);
  EXPECT_THAT(summary.message,
              testing::HasSubstr("density_gradient with a gradient of 1e+05 kg/m^4 removes"));
  EXPECT_EQ(history.time, 0) << "no step was made";
}

TEST(AddedMass, TakesItsGravityFromTheModel) {
  const Eigen::Vector3d gravity(1, 0, -9.81);
  const auto read = [&](const std::string& setting, const std::optional<Eigen::Vector3d>& model) {
    const Config config = Config::Parse(
        "{type: attached_mass, mass: 12 g, centre: [1 cm, 0, 0]" + setting + "}", "a.yaml");
    return Eigen::Vector3d(MakeEffect(config, nullptr, model)->Parameters().tail<3>());
  };
  const auto refusal = [&](const std::string& setting,
                           const std::optional<Eigen::Vector3d>& model) {
    try {
      read(setting, model);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("nothing was refused");
  };
  EXPECT_EQ(read("", gravity), gravity);
  EXPECT_EQ(read(", gravity: [100 cm/s^2, 0, -981 cm/s^2]", gravity), gravity);
  EXPECT_EQ(read(", gravity: [0, 0, 0]", gravity), Eigen::Vector3d::Zero())
      << "a mass whose weight is one of the known forces";
  EXPECT_THAT(refusal(", gravity: [0, 0, -9.81 m/s^2]", gravity),
              testing::HasSubstr("gravity: the gravity of the model is [1, 0, -9.81] m/s^2"));
  EXPECT_EQ(read(", gravity: [0, 0, -9.81 m/s^2]", {}), Eigen::Vector3d(0, 0, -9.81));
  EXPECT_THAT(refusal("", {}),
              testing::HasSubstr("gravity: must be given in a model without gravity"));
}

TEST(AddedMass, IsReadFromYaml) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: attached_mass, mass: 12 g, centre: [1 cm, 0, -3 mm], radius: 4 mm,\n"
      "     gravity: [0, -9.81 m/s^2, 0]}\n"
      "  - {type: density_gradient, gradient: 5 kg/m^3/cm}\n"
      "  - {type: attached_mass, mass: 12 g}\n"
      "  - {type: density_gradient, gradient: 5 kg/m^4, axis: [0, 0, 0]}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  Eigen::VectorXd mass(8), gradient(10);
  mass << 0.012, 0.01, 0, -0.003, 0.004, 0, -9.81, 0;
  gradient << 500, 0, 0, 1, 0, 0, 0, 0, 0, -kGravity;
  EXPECT_LT((MakeEffect(items[0])->Parameters() - mass).norm(), 1e-12);
  const Eigen::Vector3d gravity(0, 0, -kGravity);
  EXPECT_LT((MakeEffect(items[1], nullptr, gravity)->Parameters() - gradient).norm(), 1e-12);
  EXPECT_THROW(MakeEffect(items[2]), InputError) << "a place must be given";
  EXPECT_THROW(MakeEffect(items[3]), InputError) << "a direction of length 0";
}

}  // namespace
}  // namespace lacuna
