#include "effects/plane_contact.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "effects/catalogue.h"
#include "effects/contact_points.h"
#include "fem/nodal_recovery.h"
#include "fem/prescribed_force.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"

namespace lacuna {
namespace {

constexpr double kGravity = 9.81;  // m/s²

Eigen::Vector3d Total(const Eigen::VectorXd& force) {
  return force.reshaped(3, force.size() / 3).rowwise().sum();
}

// A plane that cuts the block of CheckEffect, which lies 0.05 to 0.11 m up along its normal, with
// nodes at depths on both sides of the smoothing length.
std::map<std::string, double> CuttingPlane(double friction) {
  return {{"stiffness", 2e6},  {"normal_x", 0.6},       {"normal_y", -0.5},
          {"normal_z", 1.4},   {"offset", 0.08},        {"friction", friction},
          {"smoothing", 0.01}, {"slip_velocity", 0.004}};
}

TEST(PlaneContact, PassesTheEffectChecks) {
  CheckEffect(MakeEffect("plane_contact", CuttingPlane(0.4)).get(), {.depends_on_velocity = true});
}

TEST(PlaneContact, HasAnEnergyWithoutFrictionOnly) {
  const auto contact = MakeEffect("plane_contact", CuttingPlane(0));
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.04, 0.04, 0.04}, {2, 2, 2}, 2), 1000);
  const Eigen::VectorXd position = body.mesh.nodes.reshaped(), state;
  const Eigen::VectorXd velocity = Eigen::VectorXd::Ones(position.size());
  const auto energy = [&](const Eigen::VectorXd& at) {
    return contact->Energy({body, at, velocity, velocity, 0, 0, state});
  };
  const Eigen::VectorXd force = ForceAt(*contact, body, position, velocity);
  const double h = 1e-6;  // m; truncation ~ h² / smoothing² = 1e-8
  const Eigen::VectorXd direction = force.normalized();
  const double slope =
      (*energy(position + h * direction) - *energy(position - h * direction)) / (2 * h);
  ASSERT_GT(force.norm(), 1);
  EXPECT_NEAR(-slope, force.norm(), 1e-7 * force.norm());
  EXPECT_FALSE(MakeEffect("plane_contact", CuttingPlane(0.1))
                   ->Energy({body, position, velocity, velocity, 0, 0, state})
                   .has_value());
}

TEST(PlaneContact, PushesByDepthAndAreaWithFrictionAgainstTheSlip) {
  // A block of 30 × 20 mm stands 2 mm deep: p = 1 MPa/m · (2 mm − s/2) = 1.5 kPa for s = 1 mm.
  // The area below the plane is that of the lower face, 600 mm², and for linear elements, whose
  // contact is evaluated at the nodes, half of the lowest row of triangles of the sides, which is
  // 40 mm high. The lowest points in the sides of quadratic elements are at 9 % of that height,
  // above the plane. At a slip of 4 mm/s and w = 3 mm/s friction reaches 4/5 of μ p.
  const auto contact = MakeEffect("plane_contact", {{"stiffness", 1e6},
                                                    {"offset", 0.05},
                                                    {"friction", 0.5},
                                                    {"slip_velocity", 0.003},
                                                    {"smoothing", 1e-3}});
  for (const int order : {1, 2}) {
    const Body body = MakeBody(BoxMesh({0, 0, 0.048}, {0.03, 0.02, 0.088}, {3, 2, 1}, order), 1000);
    const Eigen::VectorXd velocity = Eigen::Vector3d(0, 0.004, 0.7).replicate(body.NodeCount(), 1);
    const Eigen::Vector3d total =
        Total(ForceAt(*contact, body, body.mesh.nodes.reshaped(), velocity));
    const double area = 600e-6 + (order == 1 ? 0.5 * 0.1 * 0.04 : 0);
    EXPECT_NEAR(total.z(), 1500 * area, 1e-12);
    EXPECT_NEAR(total.y(), -0.5 * 0.8 * 1500 * area, 1e-12);
    EXPECT_NEAR(total.x(), 0, 1e-12);
  }
}

TEST(ContactPoints, GiveTheConsistentForcesOfAUniformPressure) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.03, 0.02, 0.01}, {3, 2, 1}, 2), 1000);
  const Eigen::VectorXi all = NodesWhere(body.mesh, [](const Eigen::Vector3d&) { return true; });
  Eigen::VectorXd share = Eigen::VectorXd::Zero(body.NodeCount());
  double area = 0;
  for (const ContactPoint& point : ContactPoints(body)) {
    area += point.area;
    EXPECT_NEAR(point.weight.sum(), 1, 1e-12);
    for (int k = 0; k < point.count; ++k)
      share[point.node[static_cast<size_t>(k)]] += point.area * point.weight[k];
  }
  EXPECT_NEAR(area, 22e-4, 1e-15);
  // BoundaryShares has the integrals of the shape functions in closed form.
  EXPECT_LT((share / area - BoundaryShares(body, all)).cwiseAbs().maxCoeff(), 1e-12);
}

// The patch test of contact (R. L. Taylor & P. Papadopoulos, On a patch test for contact problems
// in two dimensions, 1991): a block that is pressed on the plane is under a uniform stress.
TEST(PlaneContact, CarriesAUniformPressureWithoutDisturbingTheStress) {
  constexpr double kPressure = 2e3, kYoung = 1e5, kPoisson = 0.3;  // Pa
  const TetMesh mesh = BoxMesh({0, 0, 0}, {0.03, 0.03, 0.03}, {3, 3, 3}, 2);
  const auto body = std::make_shared<const Body>(MakeBody(mesh, 1000));
  const Eigen::Vector3d force(0, 0, -kPressure * 9e-4);
  const Eigen::VectorXi top =
      NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x.z() > 0.03 - 1e-9; });
  Model model{body,
              {MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", kPoisson}}),
               MakeEffect("plane_contact", {{"stiffness", 1e9}, {"smoothing", 1e-6}}),
               std::make_shared<PrescribedForce>(BoundaryShares(*body, top),
                                                 [force](double) { return force; })},
              {}};
  // Sliding supports that let the block expand freely.
  model.grips.push_back(
      {NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x.x() == 0; }), {}, AxisSet::Of(0)});
  model.grips.push_back({NodesWhere(mesh,
                                    [](const Eigen::Vector3d& x) {
                                      return x.x() > 0.029 && x.y() == 0 && x.z() == 0;
                                    }),
                         {},
                         AxisSet::Of(1)});
  MotionHistory history = RestHistory(model);
  // Newton's method starts in contact.
  history.position.reshaped(3, mesh.NodeCount()).row(2).array() -= 1e-6;
  const StepSummary step = Stepper(model, {.relative_tolerance = 1e-11}).Equilibrium({}, &history);
  ASSERT_TRUE(step.IsUsable()) << step.message;
  const Eigen::MatrixXd stress =
      RecoverNodalStress(model, history.position, history.velocity, 0, history.effect_state).cauchy;
  // The Cauchy stress refers to the deformed area. The tolerance is that of Newton's method; with
  // nodal quadrature, the stress would be 7 % off.
  const double stretch = 1 + kPoisson * kPressure / kYoung;
  EXPECT_LT((stress.row(2).array() + kPressure / (stretch * stretch)).abs().maxCoeff(),
            1e-5 * kPressure);
}

TEST(PlaneContact, NeverPulls) {
  const auto contact = MakeEffect("plane_contact", {{"stiffness", 1e6}, {"friction", 0.5}});
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.03, 0.02, 0.02}, {3, 2, 2}), 1000);
  // Above the plane or just on it, also when the body leaves it fast.
  const Eigen::VectorXd velocity = Eigen::Vector3d(1, 0, 5).replicate(body.NodeCount(), 1);
  Eigen::VectorXd position = body.mesh.nodes.reshaped();
  EXPECT_EQ(ForceAt(*contact, body, position, velocity).norm(), 0);
  position.reshaped(3, body.NodeCount()).row(2).array() -= 1e-4;
  EXPECT_GE(
      ForceAt(*contact, body, position, velocity).reshaped(3, body.NodeCount()).row(2).minCoeff(),
      0);
}

// Places the nodes at depths √(2 s P/k), where contact carries the pressure P of the weight of the
// block distributed over `area`.
struct Block {
  std::shared_ptr<const Body> body;
  double mass = 0;
  double depth = 0;  // m
};

Block MakeBlock(int order, const std::array<int, 3>& cells, double stiffness, double smoothing) {
  constexpr double kDensity = 1000;
  const Eigen::Vector3d size(0.03, 0.03, 0.012);  // low: it must not tip over on an incline
  Block block;
  block.body = std::make_shared<Body>(MakeBody(
      BoxMesh({-0.015, -0.015, 0}, Eigen::Vector3d(0.015, 0.015, 0.012), cells, order), kDensity));
  block.mass = kDensity * size.prod();
  block.depth = std::sqrt(2 * smoothing * kDensity * kGravity * size.z() / stiffness);
  return block;
}

TEST(PlaneContact, CarriesTheWeightOfABlockThatRests) {
  constexpr double kStiffness = 1e7, kSmoothing = 1e-4;
  for (const int order : {1, 2}) {
    const Block block = MakeBlock(order, {4, 4, 2}, kStiffness, kSmoothing);
    const auto contact =
        MakeEffect("plane_contact", {{"stiffness", kStiffness}, {"smoothing", kSmoothing}});
    const Model model{block.body,
                      {MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}}),
                       MakeEffect("gravity", {{"acceleration_z", -kGravity}}), contact},
                      {}};
    MotionHistory history = RestHistory(model);
    // The block sinks from its unloaded position. Long steps of implicit Euler damp every
    // oscillation; the slowest, of √(g/depth) ~ 500/s, decreases by a factor of 50 in a step.
    Stepper stepper(model, {.scheme = TimeScheme::kImplicitEuler});
    for (int k = 0; k < 12; ++k) {
      const StepSummary step = stepper.Step(0.1, {}, &history);
      ASSERT_TRUE(step.IsUsable()) << step.message;
    }
    const Eigen::VectorXd force =
        ForceAt(*contact, *block.body, history.position, history.velocity);
    const double weight = block.mass * kGravity;
    // Steps are solved to 1e-8 of all forces, including the elastic ones.
    EXPECT_NEAR(Total(force).z(), weight, 1e-6 * weight);
    EXPECT_LT(Total(force).head<2>().norm(), 1e-6 * weight);
    const double deepest = -history.position.reshaped(3, block.body->NodeCount()).row(2).minCoeff();
    // Not deeper than under a uniform pressure on the face, because the edges carry more.
    EXPECT_GT(deepest, 0.5 * block.depth);
    EXPECT_LT(deepest, 1.2 * block.depth);
    EXPECT_LT(deepest, 1e-4);
  }
}

// Motion down an incline: distance, velocity and acceleration in the second half of the time.
struct Slide {
  double way = 0;           // m
  double velocity = 0;      // m/s
  double acceleration = 0;  // m/s²
};

Slide SlideDown(double angle, double friction, double duration, double slip_velocity) {
  constexpr double kStiffness = 1e7, kSmoothing = 1e-4;
  const Block block = MakeBlock(1, {3, 3, 1}, kStiffness, kSmoothing);
  const Model model{block.body,
                    {MakeEffect("neo_hookean", {{"young_modulus", 1e6}, {"poisson_ratio", 0.3}}),
                     MakeEffect("gravity", {{"acceleration_x", kGravity * std::sin(angle)},
                                            {"acceleration_z", -kGravity * std::cos(angle)}}),
                     MakeEffect("stiffness_damping",
                                {{"beta", 0.002}, {"young_modulus", 1e6}, {"poisson_ratio", 0.3}}),
                     MakeEffect("plane_contact", {{"stiffness", kStiffness},
                                                  {"smoothing", kSmoothing},
                                                  {"friction", friction},
                                                  {"slip_velocity", slip_velocity}})},
                    {}};
  MotionHistory history = RestHistory(model);
  // The block starts near its equilibrium along the normal, so that it does not bounce.
  history.position.reshaped(3, block.body->NodeCount()).row(2).array() -= 0.8 * block.depth;
  Stepper stepper(model, {.scheme = TimeScheme::kBdf2});
  const Eigen::VectorXd& mass = block.body->node_mass;
  const auto mean_x = [&](const Eigen::VectorXd& field) {
    return field.reshaped(3, mass.size()).row(0).dot(mass) / mass.sum();
  };
  const Eigen::VectorXd rest = block.body->mesh.nodes.reshaped();
  constexpr int kHalf = 100;
  const double time_step = duration / (2 * kHalf);
  double velocity_at_half = 0;
  for (int k = 0; k < 2 * kHalf; ++k) {
    if (k == kHalf) velocity_at_half = mean_x(history.velocity);
    const StepSummary step = stepper.Step(time_step, {}, &history);
    EXPECT_TRUE(step.IsUsable()) << step.message;
    if (!step.IsUsable()) break;
  }
  const double velocity = mean_x(history.velocity);
  return {mean_x(history.position - rest), velocity,
          (velocity - velocity_at_half) / (duration / 2)};
}

constexpr double kAngle = 25 * std::numbers::pi / 180;

TEST(PlaneContact, HoldsABlockOnAnInclineBelowTheAngleOfFriction) {
  constexpr double kSlip = 1e-3, kShare = 0.7;  // of the friction that could be had
  const Slide slide = SlideDown(kAngle, std::tan(kAngle) / kShare, 0.2, kSlip);
  // The remaining velocity is the creep of the regularisation, the distance also the initial
  // settling.
  const double creep = kSlip * kShare / std::sqrt(1 - kShare * kShare);
  EXPECT_NEAR(slide.velocity, creep, 0.02 * creep);
  EXPECT_LT(slide.way, 0.2 * creep + 1e-4);
}

TEST(PlaneContact, LetsABlockSlideAboveTheAngleOfFriction) {
  constexpr double kDuration = 0.2;
  for (const double friction : {0.0, 0.2, 0.4}) {
    const Slide slide = SlideDown(kAngle, friction, kDuration, 1e-3);
    const double acceleration = kGravity * (std::sin(kAngle) - friction * std::cos(kAngle));
    // Regularised friction lacks a share of ½ (w/u)² of its limit, below 1e-4 at u > 60 mm/s.
    EXPECT_NEAR(slide.acceleration, acceleration, 0.002 * acceleration) << friction;
    EXPECT_GT(slide.velocity, 0.1) << friction;
  }
}

TEST(PlaneContact, IsReadFromYaml) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: plane_contact, stiffness: 100 MPa/m, normal: [0, 1, 0], offset: 20 mm,\n"
      "     friction: 0.3, slip_velocity: 2 mm/s, smoothing: 0.2 mm}\n"
      "  - {type: plane_contact, stiffness: 1 MPa/m}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  Eigen::VectorXd all(8), few(8);
  all << 1e8, 0, 1, 0, 0.02, 0.3, 2e-3, 2e-4;
  few << 1e6, 0, 0, 1, 0, 0, 1e-3, 1e-4;
  EXPECT_LT((MakeEffect(items[0])->Parameters() - all).norm(), 1e-8);
  EXPECT_LT((MakeEffect(items[1])->Parameters() - few).norm(), 1e-8);
  config.RefuseUnknownKeys();
}

TEST(PlaneContact, IsFoundByItsTypeWithItsPlane) {
  const auto damping = MakeEffect("mass_damping", {{"alpha", 1}});
  const auto contact =
      MakePlaneContact({.normal = {0, 2, 1}, .offset = 0.05, .stiffness = 1e6, .friction = 0.3});
  EXPECT_EQ(contact->Parameters(), MakeEffect("plane_contact", {{"stiffness", 1e6},
                                                                {"normal_y", 2},
                                                                {"normal_z", 1},
                                                                {"offset", 0.05},
                                                                {"friction", 0.3}})
                                       ->Parameters());
  EXPECT_EQ(FindPlaneContact({damping}), nullptr);
  EXPECT_EQ(FindPlaneContact({damping, contact}), contact.get());
  EXPECT_FALSE(ContactPlaneOf(*damping).has_value());
  EXPECT_EQ(ContactPlaneOf(*contact)->normal, Eigen::Vector3d(0, 2, 1));
  EXPECT_EQ(ContactPlaneOf(*contact)->offset, 0.05);
  EXPECT_EQ(ContactPlaneOf(*contact)->stiffness, 1e6);
  EXPECT_EQ(ContactPlaneOf(*contact)->friction, 0.3);
}

TEST(PlaneContact, RefusesAPlaneWithoutDirection) {
  const Config config =
      Config::Parse("type: plane_contact\nstiffness: 1 MPa/m\nnormal: [0, 0, 0]\n", "a.yaml");
  try {
    MakeEffect(config);
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("a.yaml:3:"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("normal"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace lacuna
