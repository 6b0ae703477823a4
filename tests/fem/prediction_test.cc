#include "fem/prediction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "effects/catalogue.h"
#include "fem/prescribed_force.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

constexpr double kTimeStep = 0.01;  // s
constexpr double kStart = 0.2;      // s

// The states that a prediction has visited.
struct Visited {
  PredictionSummary summary;
  std::vector<int> index;
  std::vector<Eigen::VectorXd> position, velocity;
  std::vector<Eigen::MatrixXd> position_jacobian;
};

// A bar under its weight, clamped at one end and deflected at the other until it is released.
struct HeldBar {
  std::shared_ptr<const Body> body;
  std::vector<std::shared_ptr<const Effect>> effects;
  Eigen::VectorXi clamped;
  Eigen::VectorXd pull;  // 3n, N
  PredictionOptions options;

  HeldBar() {
    const TetMesh mesh = Jittered(BoxMesh({0, 0, 0}, {0.08, 0.02, 0.02}, {4, 1, 1}), 0.02, 0.1, 3);
    body = std::make_shared<Body>(MakeBody(mesh, 1000));
    effects = {MakeEffect("neo_hookean", {{"young_modulus", 5e4}, {"poisson_ratio", 0.4}}),
               MakeEffect("gravity", {{"acceleration_z", -9.80665}})};
    clamped = NodesWhere(body->mesh, [](const Eigen::Vector3d& at) { return at.x() < 0.005; });
    const Eigen::VectorXi tip =
        NodesWhere(body->mesh, [](const Eigen::Vector3d& at) { return at.x() > 0.075; });
    pull.setZero(3 * body->NodeCount());
    for (const int node : tip) pull.segment<3>(3 * node) << 0, 0.02, 0.01;
    options.start_time = kStart;
    options.held_force = pull;
    options.time_step = kTimeStep;
    options.step.relative_tolerance = 1e-12;
    options.step.linear.method = LinearSolverOptions::Method::kDirect;
    options.step.linear.relative_tolerance = 1e-13;
  }

  Model MakeModel() const { return {body, effects, {Grip{clamped, {}}}}; }

  Visited Run(const std::vector<double>& times,
              const std::vector<Perturbation>& perturbations = {}) const {
    Visited visited;
    visited.summary = Predict(MakeModel(), options, times, perturbations,
                              [&](int index, const PredictedState& state) {
                                EXPECT_EQ(state.time, times[index]);
                                visited.index.push_back(index);
                                visited.position.push_back(state.position);
                                visited.velocity.push_back(state.velocity);
                                visited.position_jacobian.push_back(state.position_jacobian);
                              });
    return visited;
  }

  // The largest distance between corresponding nodes of two predictions at the same times.
  static double LargestDistance(const Visited& one, const Visited& other) {
    double largest = 0;
    for (size_t k = 0; k < one.position.size(); ++k)
      largest = std::max(largest, (one.position[k] - other.position[k]).cwiseAbs().maxCoeff());
    return largest;
  }
};

TEST(Prediction, EqualsTheMotionOfTheStepperAtTheEndsOfSteps) {
  const HeldBar bar;
  const Model model = bar.MakeModel();
  Stepper stepper(model, bar.options.step);
  MotionHistory history = RestHistory(model);
  history.time = kStart;
  ASSERT_TRUE(stepper.Equilibrium(bar.pull, &history).IsUsable());
  std::vector<double> times{history.time};
  std::vector<Eigen::VectorXd> position{history.position}, velocity{history.velocity};
  for (int step = 0; step < 6; ++step) {
    const double length = step == 0 ? 0.1 * kTimeStep : kTimeStep;
    ASSERT_TRUE(stepper.Step(length, {}, &history).IsUsable());
    times.push_back(history.time);
    position.push_back(history.position);
    velocity.push_back(history.velocity);
  }
  const Visited visited = bar.Run(times);
  ASSERT_TRUE(visited.summary.IsUsable()) << visited.summary.message;
  EXPECT_EQ(visited.summary.steps, 6);
  EXPECT_EQ(visited.summary.states, 7);
  for (size_t k = 0; k < times.size(); ++k) {
    // The cubic interpolates values and slopes of its knots, up to rounding of 1 m / h.
    EXPECT_LT((visited.position[k] - position[k]).cwiseAbs().maxCoeff(), 1e-14);
    EXPECT_LT((visited.velocity[k] - velocity[k]).cwiseAbs().maxCoeff(), 1e-11);
  }
}

TEST(Prediction, IsAsAccurateBetweenStepsAsAtTheirEnds) {
  // With damping and after some time, so that modes which the steps cannot resolve have decayed.
  constexpr double kStep = 2e-3;
  constexpr int kFirst = 20, kIntervals = 20;
  HeldBar bar;
  bar.effects.push_back(MakeEffect(
      "stiffness_damping", {{"beta", 5e-3}, {"young_modulus", 5e4}, {"poisson_ratio", 0.4}}));
  std::vector<double> times;  // ends and middles of steps, alternating
  for (int k = 0; k <= 2 * kIntervals; ++k) times.push_back(kStart + (kFirst + 0.5 * k) * kStep);
  const auto run = [&](double time_step) {
    bar.options.time_step = time_step;
    return bar.Run(times).position;
  };
  const auto truth = run(kStep / 16), whole = run(kStep), half = run(kStep / 2);
  double bend = 0, unfollowed = 0, error = 0, half_error = 0;
  for (size_t k = 1; k + 1 < times.size(); k += 2) {
    const auto past_line = [k](const std::vector<Eigen::VectorXd>& at) {
      return Eigen::VectorXd(at[k] - 0.5 * (at[k - 1] + at[k + 1]));
    };
    bend += past_line(truth).squaredNorm();
    unfollowed += (past_line(whole) - past_line(truth)).squaredNorm();
    error += (whole[k] - truth[k]).squaredNorm();
    half_error += (half[k] - truth[k]).squaredNorm();
  }
  // Linear interpolation would have an error of h² a / 8.
  EXPECT_LT(unfollowed, 0.05 * 0.05 * bend);
  // Steps of half the length, which end at these times too, have a fourth of the error.
  EXPECT_LT(half_error, 0.3 * 0.3 * error);
}

TEST(Prediction, StartsInEquilibriumAndIsReleased) {
  HeldBar bar;
  const Visited held = bar.Run({kStart - 0.1, kStart, kStart + kTimeStep});
  ASSERT_TRUE(held.summary.IsUsable());
  EXPECT_EQ(held.position[0], held.position[1]);
  EXPECT_EQ(held.velocity[1].norm(), 0);
  EXPECT_GT(held.velocity[2].norm(), 1e-2);
  // At the start the forces are in balance at the free nodes.
  const Model model = bar.MakeModel();
  const MotionHistory rest = RestHistory(model);
  Eigen::VectorXd residual;
  StepEquation(model, rest, TimeScheme::kQuasiStatic, 0).Residual(held.position[0], &residual);
  residual -= bar.pull;
  for (const int node : bar.clamped) residual.segment<3>(3 * node).setZero();
  EXPECT_LT(residual.norm(), 1e-9 * bar.pull.norm());

  // Without a holding force the body stays in equilibrium.
  bar.options.held_force = {};
  const Visited hanging = bar.Run({kStart, kStart + 5 * kTimeStep});
  // The tolerance of Newton's method, 1e-12 of the forces, divided by a stiffness of some N/m.
  EXPECT_LT((hanging.position[0] - hanging.position[1]).lpNorm<Eigen::Infinity>(), 1e-10);
}

// Compares sensitivities with central differences, at the ends of steps and between them.
void ExpectDerivative(HeldBar* bar, const Perturbation& perturbation, double step,
                      const std::function<void(double)>& shift) {
  const std::vector<double> times{kStart, kStart + 0.3 * kTimeStep, kStart + 4 * kTimeStep,
                                  kStart + 7.6 * kTimeStep};
  const Visited here = bar->Run(times, {perturbation});
  ASSERT_TRUE(here.summary.IsUsable()) << here.summary.message;
  shift(step);
  const Visited plus = bar->Run(times);
  shift(-step);
  const Visited minus = bar->Run(times);
  shift(0);
  for (size_t k = 0; k < times.size(); ++k) {
    const Eigen::VectorXd derivative = (plus.position[k] - minus.position[k]) / (2 * step);
    // Truncation errors of the differences and errors of the trajectories.
    EXPECT_LT((here.position_jacobian[k].col(0) - derivative).norm(), 1e-5 * derivative.norm())
        << times[k];
    EXPECT_GT(derivative.norm(), 0);
  }
}

TEST(Prediction, DoesNotDependOnTheStartOfTheSearchForItsEquilibrium) {
  HeldBar bar;
  bar.options.step = {.scheme = TimeScheme::kTwoStep, .relative_tolerance = 1e-6};
  const std::vector<double> times = {kStart, kStart + 0.05, kStart + 0.1};
  const Visited from_rest = bar.Run(times);
  ASSERT_TRUE(from_rest.summary.IsUsable()) << from_rest.summary.message;
  EXPECT_EQ(from_rest.summary.held, from_rest.position[0]);

  HeldBar softer;
  softer.effects[0] = MakeEffect("neo_hookean", {{"young_modulus", 4e4}, {"poisson_ratio", 0.4}});
  bar.options.held_guess = softer.Run(times).summary.held;
  ASSERT_GT((bar.options.held_guess - from_rest.position[0]).cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_LT(HeldBar::LargestDistance(bar.Run(times), from_rest), 1e-8);

  // From an inverted body no equilibrium is found.
  bar.options.held_guess = -from_rest.position[0];
  EXPECT_LT(HeldBar::LargestDistance(bar.Run(times), from_rest), 1e-8);
}

TEST(Prediction, SensitivityToTheHoldingForceAgreesWithDifferences) {
  HeldBar bar;
  Eigen::VectorXd direction = Eigen::VectorXd::Zero(bar.pull.size());
  for (Eigen::Index i = 0; i < direction.size(); ++i)
    if (bar.pull[i] != 0) direction[i] = 0.25 + 0.1 * (i % 3);
  ExpectDerivative(&bar, {.held_force = direction}, 1e-4,
                   [&](double by) { bar.options.held_force = bar.pull + by * direction; });
}

TEST(Prediction, SensitivityToTheModelAgreesWithDifferencesBetweenSteps) {
  HeldBar bar;
  const Eigen::VectorXd values = bar.effects[0]->Parameters();
  ExpectDerivative(&bar, {.effect = bar.effects[0], .parameter = 0}, 50, [&](double by) {
    bar.effects[0] = bar.effects[0]->WithParameters(values + Eigen::Vector2d(by, 0));
  });
}

// A growing load on a material with memory, in equilibrium at all times.
HeldBar LoadedBar() {
  HeldBar bar;
  const Eigen::VectorXd share =
      Eigen::VectorXd::Constant(bar.body->NodeCount(), 1.0 / bar.body->NodeCount());
  bar.effects.push_back(std::make_shared<PrescribedForce>(
      share, [](double time) { return Eigen::Vector3d(0, 0.2 * std::pow(time - kStart, 2), 0); }));
  bar.effects.push_back(MakeEffect(
      "viscoelastic_branch", {{"modulus", 3e4}, {"relaxation_time", 0.3}, {"poisson_ratio", 0.4}}));
  bar.options.held_force.setZero();
  bar.options.step.scheme = TimeScheme::kQuasiStatic;
  return bar;
}

TEST(Prediction, QuasiStaticStepsEndAtTheRequestedTimes) {
  HeldBar bar = LoadedBar();
  bar.options.time_step = 0.1;
  const std::vector<double> times{kStart, kStart + 0.1, kStart + 0.15, kStart + 0.5};
  const Visited visited = bar.Run(times);
  ASSERT_TRUE(visited.summary.IsUsable()) << visited.summary.message;
  EXPECT_EQ(visited.summary.steps, 1 + 1 + 4);
  const Model model = bar.MakeModel();
  Stepper stepper(model, bar.options.step);
  MotionHistory history = RestHistory(model);
  history.time = kStart;
  ASSERT_TRUE(stepper.Equilibrium({}, &history).IsUsable());
  for (const double length : {0.1, 0.05, 0.0875, 0.0875, 0.0875, 0.0875})
    ASSERT_TRUE(stepper.Step(length, {}, &history).IsUsable());
  EXPECT_LT((visited.position.back() - history.position).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT((visited.velocity.back() - history.velocity).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(Prediction, QuasiStaticErrorIsAtLeastOfFirstOrder) {
  const auto improves = [](HeldBar bar) {
    const auto run = [&](double time_step) {
      bar.options.time_step = time_step;
      return bar.Run({kStart, kStart + 0.4});
    };
    const Visited truth = run(0.4 / 512);
    const double whole = HeldBar::LargestDistance(run(0.1), truth);
    EXPECT_GT(whole, 1e-7);
    return whole / HeldBar::LargestDistance(run(0.05), truth);
  };
  HeldBar bar = LoadedBar();
  EXPECT_NEAR(improves(bar), 4, 0.4);  // this memory is integrated to second order
  bar.effects.back() = MakeEffect("mass_damping", {{"alpha", 50.0}});
  EXPECT_NEAR(improves(bar), std::pow(2, OrderOf(TimeScheme::kQuasiStatic)), 0.2);
}

TEST(Prediction, QuasiStaticSensitivityAgreesWithDifferences) {
  HeldBar bar = LoadedBar();
  bar.options.time_step = 0.1;
  const std::vector<double> times{kStart, kStart + 0.2, kStart + 0.4};
  const auto branch = bar.effects.back();
  const Eigen::VectorXd values = branch->Parameters();
  const double steps[] = {30, 1e-4};
  for (int k = 0; k < 2; ++k) {
    const Visited linear = bar.Run(times, {{.effect = branch, .parameter = k}});
    ASSERT_TRUE(linear.summary.IsUsable()) << linear.summary.message;
    const auto shifted = [&](double by) {
      HeldBar other = bar;
      other.effects.back() =
          branch->WithParameters(values + by * Eigen::VectorXd::Unit(values.size(), k));
      return other.Run(times).position.back();
    };
    const Eigen::VectorXd difference = (shifted(steps[k]) - shifted(-steps[k])) / (2 * steps[k]);
    EXPECT_LT((linear.position_jacobian.back() - difference).norm(), 1e-4 * difference.norm()) << k;
  }
}

TEST(Prediction, ReportsWhereItStopped) {
  HeldBar bar;
  const Eigen::VectorXd share =
      Eigen::VectorXd::Constant(bar.body->NodeCount(), 1.0 / bar.body->NodeCount());
  bar.effects.push_back(std::make_shared<PrescribedForce>(share, [](double time) {
    const double unknown = std::numeric_limits<double>::quiet_NaN();
    return Eigen::Vector3d(time > kStart + 3.5 * kTimeStep ? unknown : 0, 0, 0);
  }));
  const std::vector<double> times{kStart, kStart + 1.5 * kTimeStep, kStart + 2.5 * kTimeStep,
                                  kStart + 3.2 * kTimeStep, kStart + 6 * kTimeStep};
  const Visited visited = bar.Run(times);
  EXPECT_EQ(visited.summary.status, PredictionSummary::Status::kStopped);
  EXPECT_FALSE(visited.summary.IsUsable());
  EXPECT_NE(visited.summary.message, "");
  // The first step is short, so the fourth time lies in the fifth step, which fails.
  EXPECT_EQ(visited.summary.steps, 4);
  EXPECT_EQ(visited.summary.states, 3);
  EXPECT_THAT(visited.index, testing::ElementsAre(0, 1, 2));
  // The visited states are those of a model whose steps do not fail.
  bar.effects.pop_back();
  EXPECT_LT(HeldBar::LargestDistance(visited, bar.Run(times)), 1e-12);
}

// A negative mass stands for a void. More than there is cannot be missing; a fit that tries it goes
// on, as with any prediction that stops.
TEST(Prediction, ReportsAMassThatIsNotThere) {
  const auto with = [](double mass) {
    HeldBar bar;
    bar.effects.push_back(MakeEffect("attached_mass", {{"mass", mass},
                                                       {"centre_x", 0.08},
                                                       {"centre_y", 0.01},
                                                       {"centre_z", 0.01},
                                                       {"gravity_x", 0},
                                                       {"gravity_y", 0},
                                                       {"gravity_z", -9.80665}}));
    return bar.Run({kStart, kStart + kTimeStep});
  };
  const Visited light = with(-2e-4);  // of about 4 g around the place
  EXPECT_TRUE(light.summary.IsUsable()) << light.summary.message;
  const Visited impossible = with(-0.02);
  EXPECT_EQ(impossible.summary.status, PredictionSummary::Status::kStopped);
  EXPECT_THAT(impossible.summary.message,
              testing::StartsWith("attached_mass with a mass of -0.02 kg removes "));
  EXPECT_EQ(impossible.summary.states, 0);
}

TEST(Prediction, ReportsThatItCannotStart) {
  HeldBar bar;
  bar.options.held_force.setConstant(std::numeric_limits<double>::quiet_NaN());
  const Visited visited = bar.Run({kStart});
  EXPECT_EQ(visited.summary.status, PredictionSummary::Status::kStopped);
  EXPECT_THAT(visited.summary.message, testing::HasSubstr("no equilibrium to start from"));
  EXPECT_EQ(visited.summary.states, 0);
}

}  // namespace
}  // namespace lacuna
