// Supports along some axes only, such as planes of symmetry.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include "core/error.h"
#include "effects/catalogue.h"
#include "fem/grip_reaction.h"
#include "fem/linear_solver.h"
#include "fem/prediction.h"
#include "fem/prescribed_force.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/dense_matrix.h"
#include "support/lattice.h"

namespace lacuna {
namespace {

constexpr double kModulus = 1e5, kPoisson = 0.3;  // Pa
constexpr std::array<double, 3> kSize = {0.06, 0.03, 0.02};

// A block with planes of symmetry x = 0, y = 0, z = 0.
Model Octant(const std::string& law, int order) {
  Model model;
  const TetMesh mesh =
      Jittered(BoxMesh({0, 0, 0}, {kSize[0], kSize[1], kSize[2]}, {4, 3, 2}), 0.01, 0.15, 3);
  model.body = std::make_shared<const Body>(MakeBody(order == 1 ? mesh : ToQuadratic(mesh), 1000));
  model.effects = {MakeEffect(law, {{"young_modulus", kModulus}, {"poisson_ratio", kPoisson}})};
  for (int axis = 0; axis < 3; ++axis)
    model.grips.push_back(
        {NodesWhere(model.body->mesh, [axis](const Eigen::Vector3d& x) { return x[axis] < 1e-9; }),
         {},
         AxisSet::Of(axis)});
  return model;
}

Eigen::VectorXi End(const Model& model) {
  return NodesWhere(model.body->mesh,
                    [](const Eigen::Vector3d& x) { return x.x() > kSize[0] - 1e-9; });
}

void Pull(const Eigen::Vector3d& force, Model* model) {
  model->effects.push_back(std::make_shared<PrescribedForce>(
      BoundaryShares(*model->body, End(*model)), [force](double) { return force; }));
}

Eigen::Matrix3Xd EquilibriumOf(const Model& model, LinearSolverOptions::Method method) {
  StepOptions options;
  options.relative_tolerance = 1e-12;
  options.linear = {method, 1e-12};
  Stepper stepper(model, options);
  MotionHistory history = RestHistory(model);
  const StepSummary summary = stepper.Equilibrium({}, &history);
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
  return history.position.reshaped(3, model.body->NodeCount()) - model.body->mesh.nodes;
}

class PartialSupport : public testing::TestWithParam<int> {};

// Free to contract laterally, the block is in uniaxial tension, which all elements represent
// exactly. A clamp in place of any of the planes would disturb it.
TEST_P(PartialSupport, LeavesTheOtherAxesFree) {
  constexpr double kStrain = 1e-3;
  Model model = Octant("linear", GetParam());
  Pull({kModulus * kStrain * kSize[1] * kSize[2], 0, 0}, &model);
  for (const auto method :
       {LinearSolverOptions::Method::kDirect, LinearSolverOptions::Method::kKeptFactor}) {
    const Eigen::Matrix3Xd moved = EquilibriumOf(model, method);
    const Eigen::Matrix3Xd& rest = model.body->mesh.nodes;
    const Eigen::Vector3d strain = kStrain * Eigen::Vector3d(1, -kPoisson, -kPoisson);
    EXPECT_LT((moved - strain.asDiagonal() * rest).cwiseAbs().maxCoeff(),
              1e-9 * kStrain * kSize[0]);
    for (int axis = 0; axis < 3; ++axis)
      for (const int node : model.grips[static_cast<size_t>(axis)].nodes)
        EXPECT_EQ(moved(axis, node), 0) << "held exactly";
  }
}

INSTANTIATE_TEST_SUITE_P(Orders, PartialSupport, testing::Values(1, 2));

// The planes share edges; no force is counted twice or at an axis that is free.
TEST(PartialSupportReaction, IsTheForceThatTheSupportExerts) {
  Model model = Octant("neo_hookean", 1);
  const Eigen::Vector3d force(2, 0, 0);
  Pull(force, &model);
  PredictionOptions options;
  options.step.scheme = TimeScheme::kQuasiStatic;
  options.reactions = {{0, {}}, {1, {}}, {2, {}}};
  Eigen::VectorXd reaction;
  const PredictionSummary summary =
      Predict(model, options, {0}, {},
              [&](int, const PredictedState& state) { reaction = state.reaction; });
  ASSERT_TRUE(summary.IsUsable()) << summary.message;
  EXPECT_NEAR(reaction[0], -force.x(), 1e-6 * force.x());
  for (Eigen::Index k = 1; k < 9; ++k) {
    if (k == 4 || k == 8)
      EXPECT_NEAR(reaction[k], 0, 1e-6 * force.x()) << "no lateral load";
    else
      EXPECT_EQ(reaction[k], 0) << "the support is free along this axis";
  }
}

// Plates without friction compress a block: the reaction and the bulging follow Hooke's law, and
// their derivatives by the modulus and by the motion of the plate are exact.
TEST(PartialSupportMotion, ComesWithExactDerivatives) {
  constexpr double kStrain = -1e-3;
  Model model = Octant("linear", 1);
  const Eigen::VectorXi end = End(model);
  const Eigen::Matrix3Xd rest = model.body->mesh.nodes(Eigen::all, end);
  model.grips.push_back({end,
                         [rest](double) -> Eigen::Matrix3Xd {
                           // Only x is prescribed; the rest is ignored.
                           return rest.colwise() + Eigen::Vector3d(kStrain * kSize[0], 7, 7);
                         },
                         AxisSet::Of(0)});
  Eigen::VectorXd lift = Eigen::VectorXd::Zero(3 * model.body->NodeCount());
  for (const int node : end) lift[3 * node] = 1;
  const std::vector<Perturbation> perturbations{
      {model.effects[0], 0}, {.grip = [lift](double, const Eigen::VectorXd&) { return lift; }}};
  PredictionOptions options;
  options.step.scheme = TimeScheme::kQuasiStatic;
  options.step.relative_tolerance = 1e-12;
  options.reactions = {{3, {}}};
  const PredictionSummary summary =
      Predict(model, options, {0}, perturbations, [&](int, const PredictedState& state) {
        const Eigen::Matrix3Xd moved =
            state.position.reshaped(3, model.body->NodeCount()) - model.body->mesh.nodes;
        const double area = kSize[1] * kSize[2];
        EXPECT_NEAR(state.reaction[0], kModulus * kStrain * area, 1e-7);
        EXPECT_EQ(state.reaction[1], 0);
        EXPECT_NEAR(state.reaction_jacobian(0, 0), kStrain * area, 1e-9 * area);
        EXPECT_NEAR(state.reaction_jacobian(0, 1), kModulus * area / kSize[0], 1e-6);
        EXPECT_LT(state.position_jacobian.col(0).norm(), 1e-12) << "displacements are prescribed";
        const Eigen::Matrix3Xd by_motion = state.position_jacobian.col(1).reshaped(3, moved.cols());
        EXPECT_LT((by_motion - moved / (kStrain * kSize[0])).cwiseAbs().maxCoeff(), 1e-8);
      });
  EXPECT_TRUE(summary.IsUsable()) << summary.message;
}

// A bar in the plane z = 0 swings through large angles. The kept factor is rotated with the body,
// but not at the nodes that are held in part.
TEST(PartialSupportInMotion, IsHeldExactlyWithEachSolver) {
  std::array<Eigen::VectorXd, 2> last;
  for (const bool direct : {false, true}) {
    Model model = Octant("st_venant_kirchhoff", 1);
    model.effects.push_back(MakeEffect(
        "gravity", {{"acceleration_x", 0}, {"acceleration_y", -9.81}, {"acceleration_z", 0}}));
    model.effects[0] =
        MakeEffect("st_venant_kirchhoff", {{"young_modulus", 8e3}, {"poisson_ratio", 0.3}});
    const Eigen::VectorXi plane = model.grips[2].nodes;
    // Clamped at one edge, and in the plane z = 0 elsewhere.
    model.grips = {
        {NodesWhere(model.body->mesh, [](const Eigen::Vector3d& x) { return x.x() < 1e-9; }), {}},
        {{}, {}, AxisSet::Of(2)}};
    const std::vector<char> clamped = GrippedNodes(model);
    std::vector<int> others;
    for (const int node : plane)
      if (!clamped[static_cast<size_t>(node)]) others.push_back(node);
    model.grips[1].nodes =
        Eigen::Map<Eigen::VectorXi>(others.data(), static_cast<Eigen::Index>(others.size()));
    StepOptions options;
    options.relative_tolerance = 1e-10;
    if (direct) options.linear.method = LinearSolverOptions::Method::kDirect;
    Stepper stepper(model, options);
    MotionHistory history = RestHistory(model);
    for (int k = 0; k < 30; ++k) {
      const StepSummary step = stepper.Step(0.005, {}, &history);
      ASSERT_TRUE(step.IsUsable()) << step.message;
      for (const int node : model.grips[1].nodes) ASSERT_EQ(history.position[3 * node + 2], 0);
    }
    last[direct] = history.position - model.body->mesh.nodes.reshaped();
  }
  EXPECT_GT(last[0].lpNorm<Eigen::Infinity>(), 0.01) << "it swings far";
  EXPECT_LT((last[0] - last[1]).lpNorm<Eigen::Infinity>(), 1e-7);
}

TEST(PartialSupportSolver, AgreesWithADenseFactorisation) {
  const Lattice lattice(5);
  std::vector<AxisSet> axes(static_cast<size_t>(lattice.Nodes()));
  for (int node = 0; node < lattice.Nodes(); ++node) {
    if (lattice.fixed[static_cast<size_t>(node)]) axes[static_cast<size_t>(node)] = AxisSet::All();
    if (node % 5 == 1)
      axes[static_cast<size_t>(node)] = axes[static_cast<size_t>(node)] | AxisSet::Of(1);
    if (node % 5 == 2)
      axes[static_cast<size_t>(node)] =
          axes[static_cast<size_t>(node)] | AxisSet::Of(0) | AxisSet::Of(2);
  }
  const BlockMatrix A = lattice.Stiffness(0.2, 0.01);
  const Eigen::VectorXd b = RandomVector(3 * lattice.Nodes());
  std::vector<Eigen::Index> free;
  for (Eigen::Index k = 0; k < b.size(); ++k)
    if (!axes[static_cast<size_t>(k / 3)].Has(static_cast<int>(k % 3))) free.push_back(k);
  const Eigen::MatrixXd dense = Dense(A);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(b.size());
  const Eigen::MatrixXd free_part = dense(free, free);
  const Eigen::VectorXd free_right = b(free), solved = free_part.ldlt().solve(free_right);
  for (size_t k = 0; k < free.size(); ++k) expected[free[k]] = solved[static_cast<Eigen::Index>(k)];
  for (const auto method :
       {LinearSolverOptions::Method::kDirect, LinearSolverOptions::Method::kKeptFactor}) {
    LinearSolver solver(lattice.pattern, HeldComponents(axes), {method, 1e-12});
    Eigen::VectorXd x;
    ASSERT_TRUE(solver.Solve(A, b, &x).IsUsable());
    EXPECT_LT((x - expected).norm(), 1e-9 * expected.norm());
  }
}

TEST(PartialSupportErrors, NameANodeThatTwoGripsMove) {
  Model model = Octant("linear", 1);
  EXPECT_NO_THROW(Stepper(model, {})) << "planes of symmetry may share edges";
  model.grips.push_back({model.grips[0].nodes, {}, AxisSet::All()});
  EXPECT_THROW(Stepper(model, {}), InputError);
  model.grips.back().axes = AxisSet::Of(0);
  EXPECT_NO_THROW(Stepper(model, {})) << "at rest twice";
  model.grips.back().motion = [rest =
                                   model.body->mesh.nodes(Eigen::all, model.grips[0].nodes).eval()](
                                  double) -> Eigen::Matrix3Xd { return rest; };
  EXPECT_THROW(Stepper(model, {}), InputError);
}

}  // namespace
}  // namespace lacuna
