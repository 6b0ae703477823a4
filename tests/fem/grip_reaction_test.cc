#include "fem/grip_reaction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "effects/catalogue.h"
#include "fem/prediction.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

constexpr double kModulus = 2e5;                               // Pa
constexpr double kLength = 0.1, kWidth = 0.01, kDepth = 0.02;  // m

Grip Displaced(const TetMesh& mesh, const Eigen::VectorXi& nodes, const Eigen::Vector3d& by) {
  const Eigen::Matrix3Xd rest = mesh.nodes(Eigen::all, nodes);
  return {nodes, [rest, by](double) -> Eigen::Matrix3Xd { return rest.colwise() + by; }};
}

// The static reactions of the clamped end of a bar and of its other end, which is displaced: x, y,
// z of the clamp, then of the end.
Eigen::VectorXd ReactionsOfBar(const std::array<int, 3>& cells, const Eigen::Vector3d& by,
                               bool along_middle_line) {
  Model model;
  model.body = std::make_shared<const Body>(
      MakeBody(BoxMesh({0, 0, -0.5 * kDepth}, {kLength, kWidth, 0.5 * kDepth}, cells, 2), 1000));
  const TetMesh& mesh = model.body->mesh;
  // Without lateral contraction, so that the clamps do not disturb the strain of a bar.
  model.effects = {MakeEffect("linear", {{"young_modulus", kModulus}, {"poisson_ratio", 0}})};
  const auto at_end = [&](const Eigen::Vector3d& at) {
    return at.x() > kLength - 1e-6 && (!along_middle_line || std::abs(at.z()) < 1e-6);
  };
  model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 1e-6; }), {}},
                 Displaced(mesh, NodesWhere(mesh, at_end), by)};
  PredictionOptions options;
  options.step.scheme = TimeScheme::kQuasiStatic;
  options.step.refuse_inverted = false;
  options.reactions = {{0, {}}, {1, {}}};
  Eigen::VectorXd reaction;
  const PredictionSummary summary =
      Predict(model, options, {0}, {},
              [&](int, const PredictedState& state) { reaction = state.reaction; });
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
  return reaction;
}

TEST(GripReaction, OfABarInTensionIsModulusTimesAreaTimesStrain) {
  constexpr double kStrain = 0.02;
  const Eigen::VectorXd reaction =
      ReactionsOfBar({5, 2, 2}, {kStrain * kLength, 0, 0}, /*along_middle_line=*/false);
  const double force = kModulus * kWidth * kDepth * kStrain;  // 0.8 N
  // The strain is uniform, which the elements represent exactly: only the solver's tolerance
  // counts.
  EXPECT_NEAR(reaction[3], force, 1e-6 * force);   // the grip pulls the body outwards
  EXPECT_NEAR(reaction[0], -force, 1e-6 * force);  // so does the clamp
  for (const int other : {1, 2, 4, 5}) EXPECT_NEAR(reaction[other], 0, 1e-6 * force);
}

// A square bar that is twisted: T = G J φ/L with J = 0.1406 a⁴ (Timoshenko & Goodier, Theory of
// Elasticity, art. 109).
TEST(GripReaction, OfABarInTorsionIsThatOfSaintVenant) {
  constexpr double kSide = 0.02, kLong = 0.2, kAngle = 1e-3;
  Model model;
  model.body = std::make_shared<const Body>(
      MakeBody(BoxMesh({0, 0, 0}, {kLong, kSide, kSide}, {20, 4, 4}, 2), 1000));
  const TetMesh& mesh = model.body->mesh;
  model.effects = {MakeEffect("linear", {{"young_modulus", kModulus}, {"poisson_ratio", 0.3}})};
  const Eigen::VectorXi end =
      NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() > kLong - 1e-6; });
  const Eigen::Vector3d axis(0, 0.5 * kSide, 0.5 * kSide);
  Eigen::Matrix3Xd turned = mesh.nodes(Eigen::all, end).colwise() - axis;
  turned =
      (Eigen::AngleAxisd(kAngle, Eigen::Vector3d::UnitX()).toRotationMatrix() * turned).colwise() +
      axis;
  model.grips = {{NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 1e-6; }), {}},
                 {end, [turned](double) { return turned; }}};
  PredictionOptions options;
  options.step.scheme = TimeScheme::kQuasiStatic;
  options.reactions = {{0, axis}, {1, axis}, {1, Eigen::Vector3d(0.3, 0.1, -0.2)}};
  Eigen::VectorXd torque;
  const PredictionSummary summary = Predict(
      model, options, {0}, {}, [&](int, const PredictedState& state) { torque = state.reaction; });
  ASSERT_TRUE(summary.IsUsable()) << summary.message;
  const double expected =
      kModulus / (2 * 1.3) * 0.1406 * std::pow(kSide, 4) * kAngle / kLong;  // 8.7 µN m
  // The ends cannot warp, which stiffens a bar of ten times its side by about 1 %.
  EXPECT_GT(torque[3], expected);
  EXPECT_NEAR(torque[3], expected, 0.03 * expected);
  // Linear elasticity is in equilibrium about the undeformed places of the nodes, and the torque is
  // taken about the deformed ones, which differ by a thousandth of the bar's side.
  EXPECT_NEAR(torque[0], -torque[3], 1e-4 * expected);
  // Without a resultant force, the torque is the same about every point.
  EXPECT_NEAR(torque[6], torque[3], 1e-4 * expected);
  for (const int other : {4, 5}) EXPECT_NEAR(torque[other], 0, 1e-3 * expected);
}

TEST(GripReaction, OfACantileverIsThatOfTimoshenkosBeam) {
  constexpr double kDeflection = 1e-4;  // m
  const double inertia = kWidth * std::pow(kDepth, 3) / 12;
  const double shear = kLength / (5.0 / 6 * 0.5 * kModulus * kWidth * kDepth);
  const double bending = std::pow(kLength, 3) / (kModulus * inertia);
  // The end may rotate, or is kept upright.
  const double free = kDeflection / (bending / 3 + shear);
  const double guided = kDeflection / (bending / 12 + shear);
  const auto force = [&](bool along_middle_line) {
    return ReactionsOfBar({20, 2, 4}, {0, 0, kDeflection}, along_middle_line)[5];
  };
  // 20 quadratic elements along the beam are 0.3 % too stiff beside the clamp; along a line the
  // force makes a dent.
  EXPECT_NEAR(force(true), free, 0.01 * free);
  EXPECT_NEAR(force(false), guided, 0.01 * guided);
}

// A bar that hangs on a moving grip and is pulled aside until it is released, with everything that
// a reaction consists of: inertia, damping, memory, weight.
struct DrivenBar {
  static inline const Eigen::Vector3d kBeside{0.01, -0.02, 0.03};  // m
  std::shared_ptr<const Body> body;
  double modulus = 5e4, alpha = 3, branch = 2e4, lift = 0.004, pull = 0.02;
  double time_step = 0.004;

  DrivenBar() {
    body = std::make_shared<const Body>(
        MakeBody(Jittered(BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {4, 1, 1}), 0.02, 0.1, 3), 1000));
  }

  Model MakeModel() const {
    Model model{
        body,
        {MakeEffect("neo_hookean", {{"young_modulus", modulus}, {"poisson_ratio", 0.4}}),
         MakeEffect("gravity", {{"acceleration_z", -9.81}}),
         MakeEffect("mass_damping", {{"alpha", alpha}}),
         MakeEffect("viscoelastic_branch",
                    {{"modulus", branch}, {"relaxation_time", 0.02}, {"poisson_ratio", 0.4}})},
        {}};
    const Eigen::VectorXi nodes =
        NodesWhere(body->mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.005; });
    const Eigen::Matrix3Xd rest = body->mesh.nodes(Eigen::all, nodes);
    model.grips = {{nodes, [rest, up = lift](double time) -> Eigen::Matrix3Xd {
                      return rest.colwise() +
                             Eigen::Vector3d(0, 0, up * (1 + std::sin(30 * std::max(time, 0.0))));
                    }}};
    return model;
  }

  Eigen::VectorXd UnitPull() const {
    Eigen::VectorXd force = Eigen::VectorXd::Zero(3 * body->NodeCount());
    for (const int node :
         NodesWhere(body->mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.075; }))
      force[3 * node + 1] = 0.25;
    return force;
  }

  // Six rows per time: the force of the grip and its torque about kBeside. `by`, if given, receives
  // the Jacobian.
  Eigen::VectorXd Run(const std::vector<double>& times,
                      const std::vector<Perturbation>& perturbations = {},
                      Eigen::MatrixXd* by = nullptr) const {
    return RunModel(MakeModel(), times, perturbations, by);
  }
  Eigen::VectorXd RunModel(const Model& model, const std::vector<double>& times,
                           const std::vector<Perturbation>& perturbations,
                           Eigen::MatrixXd* by) const {
    PredictionOptions options;
    options.held_force = pull * UnitPull();
    options.time_step = time_step;
    options.step.relative_tolerance = 1e-12;
    options.step.linear.method = LinearSolverOptions::Method::kDirect;
    options.step.linear.relative_tolerance = 1e-13;
    // The force, and the torque about a point beside the grip.
    options.reactions = {{0, {}}, {0, kBeside}};
    const Eigen::Index rows = 6 * static_cast<Eigen::Index>(times.size());
    Eigen::VectorXd reaction(rows);
    if (by != nullptr) by->resize(rows, static_cast<Eigen::Index>(perturbations.size()));
    const PredictionSummary summary =
        Predict(model, options, times, perturbations, [&](int index, const PredictedState& state) {
          reaction.segment<6>(6 * index) = state.reaction;
          if (by != nullptr) by->middleRows<6>(6 * index) = state.reaction_jacobian;
        });
    EXPECT_TRUE(summary.IsUsable()) << summary.message;
    return reaction;
  }
};

TEST(GripReaction, BalancesWeightAndPullBeforeTheMotion) {
  const DrivenBar bar;
  const Eigen::VectorXd reaction = bar.Run({-0.1});
  const double weight = 9.81 * bar.body->node_mass.sum();
  EXPECT_NEAR(reaction[0], 0, 1e-8);
  EXPECT_NEAR(reaction[1], -bar.pull, 1e-8);  // four nodes with a quarter each
  EXPECT_NEAR(reaction[2], weight, 1e-8);
  // All moments about a point balance: of the grip, of the weight in the deformed middle, which is
  // not known here, and of the pull. That about y, which only the weight and the grip have, carries
  // the weight at about half of the free length.
  EXPECT_GT(-reaction[4], weight * 0.01);
  EXPECT_LT(-reaction[4], weight * 0.08);
}

// Newton's second law of the whole body: the reaction changes its momentum, beside weight and drag.
TEST(GripReaction, ChangesTheMomentum) {
  DrivenBar bar;
  bar.time_step = 5e-4;
  const Model model = bar.MakeModel();
  PredictionOptions options;
  options.time_step = bar.time_step;
  options.held_force = bar.pull * bar.UnitPull();
  options.reactions = {{0, {}}};
  std::vector<double> times;
  constexpr double kSpacing = 2e-4;  // s
  for (int k = 0; k <= 200; ++k) times.push_back(0.02 + kSpacing * k);
  Eigen::Vector3d impulse = Eigen::Vector3d::Zero(), first = impulse, last = impulse;
  const Eigen::VectorXd& mass = bar.body->node_mass;
  const PredictionSummary summary =
      Predict(model, options, times, {}, [&](int index, const PredictedState& state) {
        const Eigen::Vector3d momentum = state.velocity.reshaped(3, mass.size()) * mass;
        const double weight = index == 0 || index == 200 ? 0.5 : 1;  // trapezoidal rule
        impulse +=
            weight * kSpacing *
            (state.reaction + Eigen::Vector3d(0, 0, -9.81 * mass.sum()) - bar.alpha * momentum);
        (index == 0 ? first : last) = momentum;
      });
  ASSERT_TRUE(summary.IsUsable()) << summary.message;
  // The time step's error is about 1e-3 of the largest momentum.
  EXPECT_LT((last - first - impulse).norm(), 0.01 * (last - first).norm());
}

TEST(GripReaction, SensitivitiesAgreeWithDifferences) {
  // Before the motion, at an end of a step, and between ends.
  const std::vector<double> times{-0.01, 0.0004, 0.0125, 0.0301, 0.0498};
  DrivenBar bar;
  const Model model = bar.MakeModel();
  std::vector<Perturbation> perturbations{
      {model.effects[0], 0}, {model.effects[2], 0}, {model.effects[3], 0}};
  Perturbation pull, lift;
  pull.held_force = bar.UnitPull();
  lift.grip = [&](double time, const Eigen::VectorXd&) {
    Eigen::VectorXd up = Eigen::VectorXd::Zero(3 * bar.body->NodeCount());
    for (const int node : model.grips[0].nodes)
      up[3 * node + 2] = 1 + std::sin(30 * std::max(time, 0.0));
    return up;
  };
  perturbations.push_back(pull);
  perturbations.push_back(lift);
  Eigen::MatrixXd by;
  bar.RunModel(model, times, perturbations, &by);
  struct Varied {
    const char* name;
    double* value;
    double step;
  };
  const Varied all[] = {{"modulus", &bar.modulus, 5},
                        {"alpha", &bar.alpha, 1e-3},
                        {"branch", &bar.branch, 5},
                        {"pull", &bar.pull, 1e-5},
                        {"lift", &bar.lift, 1e-6}};
  for (Eigen::Index k = 0; k < by.cols(); ++k) {
    const Varied& varied = all[k];
    const double value = *varied.value;
    *varied.value = value + varied.step;
    const Eigen::VectorXd more = bar.Run(times);
    *varied.value = value - varied.step;
    const Eigen::VectorXd less = bar.Run(times);
    *varied.value = value;
    const Eigen::VectorXd difference = (more - less) / (2 * varied.step);
    EXPECT_GT(difference.norm(), 0) << varied.name;
    // The derivatives are analytic. The steps of the differences are so small that their truncation
    // error and the tolerance of the simulations, 1e-12 of the forces, amount to less than 1e-5.
    EXPECT_LT((by.col(k) - difference).norm(), 1e-5 * difference.norm())
        << varied.name << "\n"
        << by.col(k).transpose() << "\n"
        << difference.transpose();
  }
}

// An effect that the model does not contain changes the reaction as a small amount of it would.
TEST(GripReaction, AnEffectOutsideTheModelChangesIt) {
  const std::vector<double> times{0.0125, 0.0301};
  const DrivenBar bar;
  const auto drag = [](double amount) {
    return MakeEffect("stiffness_damping",
                      {{"beta", amount}, {"young_modulus", 5e4}, {"poisson_ratio", 0.4}});
  };
  Eigen::MatrixXd by;
  const Eigen::VectorXd without = bar.Run(times, {{drag(0), 0}}, &by);
  Model with = bar.MakeModel();
  constexpr double kAmount = 1e-7;  // s
  with.effects.push_back(drag(kAmount));
  const Eigen::VectorXd difference = (bar.RunModel(with, times, {}, nullptr) - without) / kAmount;
  EXPECT_LT((by.col(0) - difference).norm(), 1e-3 * difference.norm());
}

}  // namespace
}  // namespace lacuna
