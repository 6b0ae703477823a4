#include "fem/tangent_linear.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>

#include "effects/catalogue.h"
#include "fem/prescribed_force.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

constexpr int kSteps = 12;
constexpr double kTimeStep = 0.01;  // s
constexpr int kDamped = 2;          // index of the damping in Case::effects

// A clamped bar that is at rest under half of its weight. The other half sets it into motion while
// its clamp is lifted smoothly with the amplitude `lift` and rotated about the axis of the bar.
struct Case {
  std::shared_ptr<const Body> body;
  std::vector<std::shared_ptr<const Effect>> effects;
  Eigen::VectorXi clamped;
  double lift = 0.3;  // m/s²
  double spin = 0;    // rad/s²
  TimeScheme scheme = TimeScheme::kBdf2;

  Case() {
    const TetMesh mesh = Jittered(BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {4, 1, 1}), 0.02, 0.1, 3);
    body = std::make_shared<Body>(MakeBody(mesh, 1000));
    effects = {MakeEffect("neo_hookean", {{"young_modulus", 5e4}, {"poisson_ratio", 0.4}}),
               MakeEffect("gravity", {{"acceleration_z", -9.81}}),
               MakeEffect("stiffness_damping",
                          {{"beta", 0.004}, {"young_modulus", 5e4}, {"poisson_ratio", 0.4}})};
    std::vector<int> nodes;
    for (int i = 0; i < body->NodeCount(); ++i)
      if (body->mesh.nodes(0, i) < 0.005) nodes.push_back(i);
    clamped = Eigen::Map<Eigen::VectorXi>(nodes.data(), static_cast<Eigen::Index>(nodes.size()));
  }

  Eigen::VectorXd Lifted(double time) const {
    Eigen::VectorXd up = Eigen::VectorXd::Zero(3 * body->NodeCount());
    for (const int node : clamped) up[3 * node + 2] = 0.5 * time * time;
    return up;
  }

  Model MakeModel() const {
    Grip grip{clamped, {}};
    grip.motion = [this](double time) -> Eigen::Matrix3Xd {
      const Eigen::Matrix3d turned =
          Eigen::AngleAxisd(spin * 0.5 * time * time, Eigen::Vector3d::UnitX()).matrix();
      Eigen::Matrix3Xd places = turned * body->mesh.nodes(Eigen::all, clamped);
      places.row(2).array() += lift * 0.5 * time * time;
      return places;
    };
    return {body, effects, {grip}};
  }

  // The final position and velocity and their sensitivities to `perturbations`.
  void Run(const std::vector<Perturbation>& perturbations, Eigen::VectorXd* position,
           Eigen::VectorXd* velocity, Eigen::MatrixXd* by_position = nullptr,
           Eigen::MatrixXd* by_velocity = nullptr) const {
    const Model model = MakeModel();
    StepOptions options;
    options.scheme = scheme;
    options.relative_tolerance = 1e-12;
    options.linear.method = LinearSolverOptions::Method::kDirect;
    options.linear.relative_tolerance = 1e-13;
    Stepper stepper(model, options);
    TangentLinear linear(model, perturbations);
    MotionHistory history = RestHistory(model);
    MotionHistory before = history;
    ASSERT_TRUE(stepper.Equilibrium({}, &history).IsUsable());
    ASSERT_TRUE(linear.Advance(before, TimeScheme::kQuasiStatic, 0, history.position).IsUsable());
    for (int step = 0; step < kSteps; ++step) {
      before = history;
      ASSERT_TRUE(stepper.Step(kTimeStep, {}, &history).IsUsable());
      ASSERT_TRUE(linear.Advance(before, scheme, kTimeStep, history.position).IsUsable());
    }
    *position = history.position;
    *velocity = history.velocity;
    if (by_position != nullptr) *by_position = linear.position();
    if (by_velocity != nullptr) *by_velocity = linear.velocity();
  }
};

// Compares with central differences of whole trajectories, also the velocities where the body has
// inertia. `tolerance` is relative; with symmetric
// tangents, truncation errors and errors of the trajectories amount to 1e-5.
void ExpectDerivative(const Case& motion, const Perturbation& perturbation, double step,
                      const std::function<void(double)>& shift, double tolerance,
                      const std::string& name) {
  Eigen::VectorXd position, velocity, plus, plus_velocity, minus, minus_velocity;
  Eigen::MatrixXd by_position, by_velocity;
  motion.Run({perturbation}, &position, &velocity, &by_position, &by_velocity);
  shift(step);
  motion.Run({}, &plus, &plus_velocity);
  shift(-step);
  motion.Run({}, &minus, &minus_velocity);
  shift(0);
  const Eigen::VectorXd difference = (plus - minus) / (2 * step);
  const Eigen::VectorXd velocity_difference = (plus_velocity - minus_velocity) / (2 * step);
  ASSERT_GT(difference.norm(), 0) << name;
  EXPECT_LT((by_position.col(0) - difference).norm(), tolerance * difference.norm()) << name;
  if (motion.scheme == TimeScheme::kQuasiStatic) return;
  EXPECT_LT((by_velocity.col(0) - velocity_difference).norm(),
            tolerance * velocity_difference.norm())
      << name;
}

void ExpectParameterDerivative(const Case& motion, const std::shared_ptr<const Effect>& effect,
                               int parameter, double step, double tolerance) {
  Case shifted = motion;
  const auto place = std::find(shifted.effects.begin(), shifted.effects.end(), effect);
  ASSERT_NE(place, shifted.effects.end());
  const Eigen::VectorXd values = effect->Parameters();
  const auto shift = [&](double by) {
    *place =
        by == 0
            ? effect
            : effect->WithParameters(values + by * Eigen::VectorXd::Unit(values.size(), parameter));
  };
  ExpectDerivative(shifted, {effect, parameter, {}}, step, shift, tolerance,
                   effect->Card().type + "." + effect->Card().parameters[parameter].name);
}

TEST(TangentLinear, AgreesWithDifferencesForEveryParameterOfTheModel) {
  for (const TimeScheme scheme :
       {TimeScheme::kBdf2, TimeScheme::kImplicitEuler, TimeScheme::kTwoStep}) {
    Case motion;
    motion.scheme = scheme;
    motion.effects.resize(2);  // symmetric tangents only
    ExpectParameterDerivative(motion, motion.effects[0], 0, 50, 1e-5);
    ExpectParameterDerivative(motion, motion.effects[0], 1, 1e-4, 1e-5);
    ExpectParameterDerivative(motion, motion.effects[1], 2, 1e-2, 1e-5);
  }
}

TEST(TangentLinear, HoldsForTangentsThatAreNotSymmetric) {
  // In a strained body that rotates, the contributions of ∂f/∂x and ∂f/∂v of the damping nearly
  // cancel.
  Case motion;
  motion.spin = 100;
  motion.effects.push_back(MakeEffect("swelling", {{"strain", 0.01}}));
  ExpectParameterDerivative(motion, motion.effects[0], 0, 50, 1e-5);
  ExpectParameterDerivative(motion, motion.effects[0], 1, 1e-4, 1e-5);
  ExpectParameterDerivative(motion, motion.effects[kDamped], 0, 1e-6, 1e-5);
  ExpectParameterDerivative(motion, motion.effects.back(), 0, 1e-4, 1e-5);
}

// The swelling strain refers to the elasticity law, whose parameters therefore act twice.
TEST(TangentLinear, CountsWhatTheModuliChangeInAnotherEffect) {
  Case motion;
  motion.spin = 100;  // without it the velocities hardly depend on the strain
  motion.effects.push_back(MakeEffect("swelling", {{"strain", 0.05}}));
  ExpectParameterDerivative(motion, motion.effects[0], 0, 50, 1e-5);
  ExpectParameterDerivative(motion, motion.effects[0], 1, 1e-4, 1e-5);
  ExpectParameterDerivative(motion, motion.effects.back(), 0, 1e-4, 1e-5);
}

TEST(TangentLinear, HoldsForForcesWithoutAPotential) {
  Case motion;
  motion.spin = 100;
  motion.effects[kDamped] = MakeEffect("follower_force", {{"force_x", 0},
                                                          {"force_y", 0},
                                                          {"force_z", -0.01},
                                                          {"centre_x", 0.07},
                                                          {"centre_y", 0.01},
                                                          {"centre_z", 0.01},
                                                          {"radius", 0.02}});
  ExpectParameterDerivative(motion, motion.effects[0], 0, 50, 1e-5);
  ExpectParameterDerivative(motion, motion.effects[kDamped], 2, 1e-4, 1e-5);
  motion.effects[kDamped] =
      MakeEffect("pressure", {{"pressure", 200}, {"point_x", 0.04}, {"normal_x", 1}});
  ExpectParameterDerivative(motion, motion.effects[0], 0, 50, 1e-5);
  ExpectParameterDerivative(motion, motion.effects[kDamped], 0, 1, 1e-5);
}

TEST(TangentLinear, FollowsTheMemoryOfEffects) {
  Case motion;
  motion.effects[kDamped] = MakeEffect(
      "viscoelastic_branch", {{"modulus", 2e4}, {"relaxation_time", 0.03}, {"poisson_ratio", 0.4}});
  ExpectParameterDerivative(motion, motion.effects[0], 0, 50, 1e-5);
  ExpectParameterDerivative(motion, motion.effects[kDamped], 0, 50, 1e-5);
  ExpectParameterDerivative(motion, motion.effects[kDamped], 1, 1e-4, 1e-4);
}

// A load that grows in every other step: where it stands still, points that have flowed stand
// exactly at their limit.
TEST(TangentLinear, KeepsTheDerivativesOfAFlowWhereNothingMoves) {
  Case motion;
  motion.scheme = TimeScheme::kQuasiStatic;
  motion.lift = 0;
  Eigen::VectorXd share = Eigen::VectorXd::Zero(motion.body->NodeCount());
  for (int i = 0; i < motion.body->NodeCount(); ++i)
    if (motion.body->mesh.nodes(0, i) > 0.075) share[i] = 1;
  const auto load = std::make_shared<PrescribedForce>(share / share.sum(), [](double time) {
    const double grown = 2 * std::floor((time / kTimeStep + 0.5) / 2) / kSteps;
    return Eigen::Vector3d(0, 0, 0.02 * grown);
  });
  const auto elastic = motion.effects[0];
  for (const auto& flowing :
       {MakeEffect("elastoplastic_branch", {{"modulus", 3e4}, {"yield_strain", 0.001}}),
        MakeEffect("softening",
                   {{"modulus", 3e4}, {"softening_strain", 0.02}, {"poisson_ratio", 0.4}}),
        MakeEffect("slipping_support", {{"modulus", 1e3}, {"slip_distance", 5e-4}})}) {
    motion.effects = {elastic, flowing, load};
    ExpectParameterDerivative(motion, elastic, 0, 20, 1e-3);
    for (const int own : {0, 1})
      ExpectParameterDerivative(motion, flowing, own, 1e-4 * flowing->Parameters()[own], 1e-3);
  }
}

// A stiff block between an elastic bed and one that slips at 10 µm, the smallest plausible
// distance. The first load moves the block by u = (F − k d A)/(k₂ A) and its bed by u − d. Under
// the second load it sticks to the bed, 0.5 µm from the opposite limit, so that du/dF = 1/(k₂ A)
// stays. A difference over 1 µm of slip would pass the limit.
TEST(TangentLinear, ResolvesTheLimitOfASlip) {
  constexpr double kBed = 1e6, kOther = 4e5;  // k and k₂, Pa/m
  constexpr double kLimit = 1e-5;             // d, m
  const auto body =
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, {0.03, 0.02, 0.04}, {3, 2, 4}), 1000));
  const Eigen::VectorXd areas = NodeBoundaryAreas(*body);
  const double area = areas.sum(), slip = 4 * kLimit;
  const double first = area * (kOther * (slip + kLimit) + kBed * kLimit);
  const double second = area * (kOther * slip - 0.95 * kLimit * (kBed + kOther));
  const auto gravity = MakeEffect("gravity", {{"acceleration_x", 0}});
  const auto load = std::make_shared<PrescribedForce>(areas / area, [=](double time) {
    return Eigen::Vector3d(time < 1.5 ? first : second, 0, 0);
  });
  const Model model{body,
                    {MakeEffect("linear", {{"young_modulus", 1e9}, {"poisson_ratio", 0}}),
                     MakeEffect("slipping_support", {{"modulus", kBed}, {"slip_distance", kLimit}}),
                     MakeEffect("elastic_support", {{"modulus", kOther}}), gravity, load},
                    {}};
  Stepper stepper(model, {.scheme = TimeScheme::kQuasiStatic});
  TangentLinear linear(model, {Perturbation{gravity, 0}});
  MotionHistory history = RestHistory(model);
  const double by_gravity = body->node_mass.sum() / (kOther * area);
  for (const double place : {slip + kLimit, slip - 0.95 * kLimit}) {
    const MotionHistory before = history;
    const StepSummary step = stepper.Step(1, {}, &history);
    ASSERT_TRUE(step.IsUsable()) << step.message;
    ASSERT_TRUE(linear.Advance(before, TimeScheme::kQuasiStatic, 1, history.position).IsUsable());
    const Eigen::Matrix3Xd moved =
        history.position.reshaped(3, body->NodeCount()) - body->mesh.nodes;
    // Under tractions of some 10 Pa the block is strained by 1e-8 of its 30 mm.
    EXPECT_NEAR(moved.row(0).mean(), place, 1e-4 * kLimit);
    const Eigen::Matrix3Xd change = linear.position().col(0).reshaped(3, body->NodeCount());
    EXPECT_NEAR(change.row(0).mean(), by_gravity, 1e-4 * by_gravity);
  }
}

TEST(TangentLinear, GivesTheResponseToAnEffectWithMemoryOutsideTheModel) {
  Case motion;
  motion.effects.resize(2);
  const auto branch = MakeEffect(
      "viscoelastic_branch", {{"modulus", 0}, {"relaxation_time", 0.03}, {"poisson_ratio", 0.4}});
  Case with = motion;
  with.effects.push_back(branch);
  Eigen::VectorXd position, velocity, plus, without;
  Eigen::MatrixXd by_position;
  motion.Run({{branch, 0}}, &without, &velocity, &by_position);
  const double little =
      5;  // Pa, for a body of 50 kPa: the quadratic term is 1e-4 of the linear one
  with.effects.back() = branch->WithParameters(Eigen::Vector3d(little, 0.03, 0.4));
  with.Run({}, &plus, &velocity);
  const Eigen::VectorXd difference = (plus - without) / little;
  EXPECT_LT((by_position.col(0) - difference).norm(), 1e-3 * difference.norm());
}

TEST(TangentLinear, GivesTheResponseToAnEffectOutsideTheModel) {
  Case motion;
  motion.effects.resize(2);
  const auto damping = MakeEffect("mass_damping", {{"alpha", 0}});
  const Perturbation little{damping, 0, {}};
  Case with = motion;
  with.effects.push_back(damping);
  Eigen::VectorXd position, velocity, plus, minus;
  Eigen::MatrixXd by_position;
  motion.Run({little}, &position, &velocity, &by_position);
  with.effects.back() = damping->WithParameters(Eigen::VectorXd::Constant(1, 1e-3));
  with.Run({}, &plus, &velocity);
  with.effects.back() = damping->WithParameters(Eigen::VectorXd::Constant(1, -1e-3));
  with.Run({}, &minus, &velocity);
  const Eigen::VectorXd difference = (plus - minus) / 2e-3;
  EXPECT_LT((by_position.col(0) - difference).norm(), 1e-5 * difference.norm());
}

TEST(TangentLinear, FollowsTheGrip) {
  Case motion;
  motion.effects.resize(2);
  const double lift = motion.lift;
  const Perturbation higher{
      nullptr, 0, [&](double time, const Eigen::VectorXd&) { return motion.Lifted(time); }};
  ExpectDerivative(
      motion, higher, 1e-3, [&](double by) { motion.lift = lift + by; }, 1e-5, "lift");
}

TEST(TangentLinear, TreatsItsPerturbationsIndependently) {
  const Case motion;
  const std::vector<Perturbation> all{
      {motion.effects[0], 0, {}}, {motion.effects[0], 1, {}}, {motion.effects[1], 2, {}}};
  Eigen::VectorXd position, velocity;
  Eigen::MatrixXd together, alone;
  motion.Run(all, &position, &velocity, &together);
  for (size_t k = 0; k < all.size(); ++k) {
    motion.Run({all[k]}, &position, &velocity, &alone);
    // Rounding: triangular solves use a different algorithm for many right-hand sides.
    EXPECT_LT((together.col(k) - alone.col(0)).norm(), 1e-10 * alone.norm());
  }
}

}  // namespace
}  // namespace lacuna
