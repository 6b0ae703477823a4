#include "fem/reduced_response.h"

#include <gtest/gtest.h>

#include <cmath>

#include "effects/catalogue.h"
#include "fem/prediction.h"
#include "fem/prescribed_force.h"
#include "support/box_mesh.h"
#include "support/test_effect.h"

namespace lacuna {
namespace {

constexpr double kStart = 0.1, kStep = 0.005;  // s

// A damped bar under its weight, deflected and released, with large deflections.
struct SwingingBar {
  Model model;
  PredictionOptions options;
  Eigen::VectorXd pull, share;
  std::vector<double> times;

  SwingingBar() {
    model.body = std::make_shared<const Body>(
        MakeBody(BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {4, 1, 1}, 2), 1000));
    const TetMesh& mesh = model.body->mesh;
    model.effects = {MakeEffect("neo_hookean", {{"young_modulus", 5e4}, {"poisson_ratio", 0.4}}),
                     MakeEffect("gravity", {{"acceleration_z", -9.80665}}),
                     MakeEffect("mass_damping", {{"alpha", 3.0}})};
    model.grips = {
        {NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.001; }), {}}};
    const Eigen::VectorXi tip =
        NodesWhere(mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.079; });
    pull.setZero(3 * model.body->NodeCount());
    for (const int node : tip) pull.segment<3>(3 * node) << 0, 0.01, 0.005;
    share = model.body->node_mass / model.body->node_mass.sum();
    options.start_time = kStart;
    options.time_step = kStep;
    options.held_force = pull;
    options.step.relative_tolerance = 1e-12;
    for (int k = 0; k <= 60; ++k) times.push_back(kStart + kStep * k);
  }
};

double Push(double time) { return 0.3 + std::sin(20 * (time - kStart)); }

// The motion of the bar, with the sensitivities of the tangent-linear model.
struct Followed {
  std::vector<TrajectoryState> states;
  std::vector<Eigen::MatrixXd> exact;

  Followed(const SwingingBar& bar, const std::vector<Perturbation>& perturbations) {
    const PredictionSummary summary = Predict(
        bar.model, bar.options, bar.times, perturbations, [&](int, const PredictedState& state) {
          states.push_back({state.time,
                            state.position,
                            state.velocity,
                            {Eigen::VectorXd(), Eigen::VectorXd(), Eigen::VectorXd()}});
          exact.push_back(state.position_jacobian);
        });
    EXPECT_TRUE(summary.IsUsable()) << summary.message;
  }
};

TEST(ReducedResponse, AgreesWithTheTangentLinearModel) {
  const SwingingBar bar;
  const int n = bar.model.body->NodeCount();
  const auto push = std::make_shared<PrescribedForce>(
      bar.share, [](double time) { return Eigen::Vector3d(0, Push(time), 0); });
  const auto [states, exact] = Followed(bar, {{.effect = push}, {.held_force = bar.pull}});
  ASSERT_EQ(exact.size(), bar.times.size());

  Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(3 * n, 2);
  for (int i = 0; i < n; ++i) shapes(3 * i + 1, 0) = bar.share[i];
  shapes.col(1) = bar.pull;
  const ReducedResponse response(bar.model, states, shapes, {.time_step = kStep});
  ASSERT_TRUE(response.IsUsable()) << response.message();
  EXPECT_LE(response.basis().cols(), 24);  // 2 moments of 2 shapes at 6 states
  const auto history = [](double time) -> Eigen::MatrixXd {
    return Eigen::Vector2d(Push(time), 0) * Eigen::RowVector2d(1, 0);
  };
  Eigen::MatrixXd held = history(kStart);
  held(1, 1) = 1;
  double difference[2] = {0, 0}, size[2] = {0, 0};
  response.Respond(
      held, history, bar.times,
      [&, &exact = exact](int index, const Eigen::MatrixXd& q, const Eigen::MatrixXd&) {
        const Eigen::MatrixXd moved = response.basis() * q;
        for (int k = 0; k < 2; ++k) {
          difference[k] += (moved - exact[index]).col(k).squaredNorm();
          size[k] += exact[index].col(k).squaredNorm();
        }
      });
  // Errors of two moments at six states and of the interpolation of the tangents. The abrupt
  // release excites shapes that the basis does not contain.
  EXPECT_LT(std::sqrt(difference[0] / size[0]), 0.03);
  EXPECT_LT(std::sqrt(difference[1] / size[1]), 0.06);
}

TEST(ReducedResponse, FollowsAQuasiStaticMotion) {
  SwingingBar bar;
  bar.options.step.scheme = TimeScheme::kQuasiStatic;
  bar.options.held_force.setZero();
  bar.times = {kStart, kStart + 0.1, kStart + 0.13, kStart + 0.3};
  const auto push = std::make_shared<PrescribedForce>(
      bar.share, [](double time) { return Eigen::Vector3d(0, Push(time), 0); });
  const auto [states, exact] = Followed(bar, {{.effect = push}});
  ASSERT_EQ(exact.size(), bar.times.size());
  const int n = bar.model.body->NodeCount();
  Eigen::MatrixXd shapes = Eigen::MatrixXd::Zero(3 * n, 1);
  for (int i = 0; i < n; ++i) shapes(3 * i + 1, 0) = bar.share[i];
  const ReducedResponse response(bar.model, states, shapes,
                                 {.scheme = TimeScheme::kQuasiStatic, .time_step = kStep});
  ASSERT_TRUE(response.IsUsable()) << response.message();
  const auto history = [](double time) -> Eigen::MatrixXd {
    return Eigen::MatrixXd::Constant(1, 1, Push(time));
  };
  std::vector<int> visited;
  response.Respond(
      history(kStart), history, bar.times,
      [&, &exact = exact](int index, const Eigen::MatrixXd& q, const Eigen::MatrixXd&) {
        visited.push_back(index);
        EXPECT_LT((response.basis() * q - exact[index]).norm(), 0.02 * exact[index].norm());
      });
  EXPECT_EQ(visited, (std::vector<int>{0, 1, 2, 3}));
}

// A support of each node that acts in steps with inertia only.
class MovingSupport final : public TestEffect<MovingSupport> {
 public:
  static constexpr const char* kType = "moving_support";
  void AddTangents(const Kinematics& at, const TangentWeights& weights, bool,
                   BlockMatrix* tangent) const override {
    constexpr double kStiffness = 100;  // N/m; that of the bar at its tip is 4 N/m
    if (!at.has_inertia) return;
    for (const int diagonal : tangent->pattern().diagonal)
      tangent->Block(diagonal).diagonal().array() -= weights.position * kStiffness;
  }
};

TEST(ReducedResponse, EvaluatesEffectsWithTheInertiaOfTheMotion) {
  SwingingBar bar;
  bar.model.effects.push_back(std::make_shared<const MovingSupport>());
  const Eigen::VectorXd rest = bar.model.body->mesh.nodes.reshaped();
  const std::vector<TrajectoryState> states = {
      {kStart, rest, 0 * rest, std::vector<Eigen::VectorXd>(bar.model.effects.size())}};
  const auto deflection = [&](TimeScheme scheme) {
    const ReducedResponse response(bar.model, states, bar.pull,
                                   {.scheme = scheme, .time_step = kStep});
    EXPECT_TRUE(response.IsUsable()) << response.message();
    const Eigen::MatrixXd one = Eigen::MatrixXd::Ones(1, 1);
    double norm = 0;
    response.Respond(
        one, [&](double) { return one; }, {kStart},
        [&](int, const Eigen::MatrixXd& position, const Eigen::MatrixXd&) {
          norm = (response.basis() * position).norm();
        });
    return norm;
  };
  const double supported = deflection(TimeScheme::kTwoStep);
  EXPECT_GT(supported, 0);
  EXPECT_LT(supported, 0.5 * deflection(TimeScheme::kQuasiStatic));
}

}  // namespace
}  // namespace lacuna
