// Dynamics: order of accuracy, frequencies, energy and momentum.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"

namespace lacuna {
namespace {

constexpr double kLength = 0.2, kSide = 0.02, kYoung = 1e6, kDensity = 1000;

Model Bar(const std::string& law, const std::array<int, 3>& cells, int order, bool clamped) {
  const TetMesh mesh = BoxMesh({0, 0, 0}, {kLength, kSide, kSide}, cells, order);
  Model model{std::make_shared<const Body>(MakeBody(mesh, kDensity)), {}, {}};
  model.effects = {MakeEffect(law, {{"young_modulus", kYoung}, {"poisson_ratio", 0.3}})};
  if (clamped) {
    model.grips.push_back(
        {NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x[0] < 1e-9; }), {}});
  }
  return model;
}

double KineticEnergy(const Model& model, const MotionHistory& history) {
  double energy = 0;
  for (int i = 0; i < model.body->NodeCount(); ++i) {
    energy += 0.5 * model.body->node_mass[i] * history.velocity.segment<3>(3 * i).squaredNorm();
  }
  return energy;
}

double TotalEnergy(const Model& model, const MotionHistory& history) {
  double energy = KineticEnergy(model, history);
  for (size_t j = 0; j < model.effects.size(); ++j) {
    energy +=
        *model.effects[j]->Energy({*model.body, history.position, history.velocity,
                                   history.velocity, history.time, 0.01, history.effect_state[j]});
  }
  return energy;
}

void Throw(const Model& model,
           const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& velocity,
           MotionHistory* history) {
  for (int i = 0; i < model.body->NodeCount(); ++i) {
    history->velocity.segment<3>(3 * i) = velocity(model.body->mesh.nodes.col(i));
  }
}

MotionHistory Moved(const Model& model, TimeScheme scheme, double duration, int steps,
                    MotionHistory history) {
  Stepper stepper(model, {.scheme = scheme, .relative_tolerance = 1e-11});
  for (int k = 0; k < steps; ++k) {
    const StepSummary summary = stepper.Step(duration / steps, {}, &history);
    EXPECT_TRUE(summary.IsUsable()) << summary.message;
  }
  return history;
}

// A clamped bar with a smooth initial velocity that deflects by about 20° within a quarter period.
MotionHistory Swing(const Model& model) {
  MotionHistory history = RestHistory(model);
  Throw(
      model,
      [](const Eigen::Vector3d& x) {
        const double s = x[0] / kLength;
        return Eigen::Vector3d(0, 0.3 * s * s, 0.8 * s * s);
      },
      &history);
  return history;
}

double ObservedOrder(TimeScheme scheme, const std::vector<std::shared_ptr<const Effect>>& more,
                     int steps) {
  Model model = Bar("neo_hookean", {6, 1, 1}, 1, true);
  model.effects.insert(model.effects.end(), more.begin(), more.end());
  const MotionHistory start = Swing(model);
  constexpr double kDuration = 0.015;
  const auto at = [&](int count) { return Moved(model, scheme, kDuration, count, start).position; };
  const Eigen::VectorXd coarse = at(steps), medium = at(2 * steps), fine = at(4 * steps);
  return std::log2((coarse - medium).norm() / (medium - fine).norm());
}

// Without damping the steps must resolve the highest modes of the mesh too, with periods of about 1
// ms. The tolerances allow for the error term of the next order at the smallest step.
std::vector<std::shared_ptr<const Effect>> GravityAndDamping() {
  return {MakeEffect("gravity", {{"acceleration_z", -9.81}}),
          MakeEffect("mass_damping", {{"alpha", 5}}),
          MakeEffect("stiffness_damping",
                     {{"beta", 1e-3}, {"young_modulus", kYoung}, {"poisson_ratio", 0.3}})};
}

TEST(TimeSchemes, ImplicitEulerIsOfOrderOne) {
  EXPECT_NEAR(ObservedOrder(TimeScheme::kImplicitEuler, GravityAndDamping(), 200), 1, 0.1);
}
TEST(TimeSchemes, Bdf2IsOfOrderTwo) {
  EXPECT_NEAR(ObservedOrder(TimeScheme::kBdf2, {}, 400), 2, 0.1);
}
TEST(TimeSchemes, Bdf2IsOfOrderTwoWithDampingAndGravity) {
  EXPECT_NEAR(ObservedOrder(TimeScheme::kBdf2, GravityAndDamping(), 80), 2, 0.1);
}

TEST(TimeSchemes, TwoStepIsOfOrderTwo) {
  EXPECT_NEAR(ObservedOrder(TimeScheme::kTwoStep, {}, 400), 2, 0.1);
}
TEST(TimeSchemes, TwoStepIsOfOrderTwoWithDampingAndGravity) {
  EXPECT_NEAR(ObservedOrder(TimeScheme::kTwoStep, GravityAndDamping(), 80), 2, 0.1);
}

// Integrates ẍ = −ω² x over one period from rest at 1, with a first step a tenth as long as the
// others.
std::complex<double> AfterAPeriod(TimeScheme scheme, int steps) {
  const double h = 2 * std::numbers::pi / (steps - 0.9);
  double x = 1, v = 0, a = 0, x_before = 0, v_before = 0, a_before = 0, last = 0;
  for (int step = 0; step < steps; ++step) {
    const double length = step == 0 ? 0.1 * h : h;
    const SchemeWeights weights = WeightsOf(scheme, length, step, last);
    const double x_history = weights.Combine(x, x_before, v, v_before);
    const double v_history = weights.Combine(v, v_before, a, a_before);
    x_before = x, v_before = v, a_before = a, last = length;
    const double square = weights.rate * weights.rate;
    x = (square * x_history + weights.rate * v_history) / (square + 1);
    v = weights.rate * (x - x_history);
    a = weights.rate * (v - v_history);
  }
  return {x, -v};
}

TEST(TimeSchemes, TwoStepHasAThirdOfTheErrorOfBdf2) {
  const std::complex<double> bdf2 = AfterAPeriod(TimeScheme::kBdf2, 100);
  const std::complex<double> two_step = AfterAPeriod(TimeScheme::kTwoStep, 100);
  // The phase error is 2π C (ωh)² with the error constants C = 1/3 and C = 0.099 of the two
  // schemes.
  const double square = std::pow(2 * std::numbers::pi / 99.1, 2);
  EXPECT_NEAR(-std::arg(bdf2) / (2 * std::numbers::pi * square), 1.0 / 3, 0.03);
  EXPECT_NEAR(-std::arg(two_step) / (2 * std::numbers::pi * square), 0.099, 0.01);
  EXPECT_LT(std::abs(1 - std::abs(two_step)), 0.2 * std::abs(1 - std::abs(bdf2)));
}

TEST(TimeSchemes, Bdf2StaysOfOrderTwoWhenTheStepChanges) {
  const Model model = Bar("neo_hookean", {6, 1, 1}, 1, true);
  const MotionHistory start = Swing(model);
  // Steps with the repeated ratios 1 : 2 : 3 : 2.
  const auto at = [&](int rounds) {
    Stepper stepper(model, {.scheme = TimeScheme::kBdf2, .relative_tolerance = 1e-11});
    MotionHistory history = start;
    for (int k = 0; k < 4 * rounds; ++k) {
      constexpr int kPattern[4] = {1, 2, 3, 2};
      const StepSummary summary =
          stepper.Step(0.015 * kPattern[k % 4] / (8.0 * rounds), {}, &history);
      EXPECT_TRUE(summary.IsUsable()) << summary.message;
    }
    return history.position;
  };
  const Eigen::VectorXd coarse = at(100), medium = at(200), fine = at(400);
  EXPECT_NEAR(std::log2((coarse - medium).norm() / (medium - fine).norm()), 2, 0.15);
}

TEST(Vibration, HasTheFirstFrequencyOfBeamTheory) {
  // At this slenderness the frequency of Timoshenko's cantilever is 1.3 % below that of
  // Euler–Bernoulli's (the factor 1 + (1/2)(β r)²(…) of Thomson, Theory of Vibration, ch. 8).
  const double inertia = std::pow(kSide, 4) / 12, area = kSide * kSide;
  const double beta = 1.875104 / kLength;
  const double euler =
      beta * beta * std::sqrt(kYoung * inertia / (kDensity * area)) / (2 * std::numbers::pi);
  // Rotary inertia and shear, to first order in (β r)²: f = f_EB (1 − ½ (β r)² c (1 + E/(κG))) with
  // c = ∫φ'²/(β²∫φ²) = 1.3221 for the first clamped–free mode.
  const double radius_squared = inertia / area;
  const double kappa = 10 * 1.3 / (12 + 11 * 0.3);
  const double theory =
      euler * (1 - 0.5 * beta * beta * radius_squared * 1.3221 * (1 + 2 * 1.3 / kappa));

  const Model model = Bar("linear", {16, 2, 2}, 2, true);
  MotionHistory history = RestHistory(model);
  Throw(
      model,
      [&](const Eigen::Vector3d& x) {
        // A small deflection in the shape of the first mode.
        const double z = beta * x[0], sigma = 0.734096;
        return Eigen::Vector3d(
            0, 0, 1e-3 * (std::cosh(z) - std::cos(z) - sigma * (std::sinh(z) - std::sin(z))));
      },
      &history);
  const Eigen::VectorXi tip =
      NodesWhere(model.body->mesh, [](const Eigen::Vector3d& x) { return x[0] > kLength - 1e-9; });
  // BDF2 lowers the frequency by 0.1 % at 200 steps per period.
  const double step = 1 / (200 * theory);
  Stepper stepper(model, {.scheme = TimeScheme::kBdf2});
  std::vector<double> crossings;
  double last = 0;
  while (crossings.size() < 3 && history.time < 3 / theory) {
    ASSERT_TRUE(stepper.Step(step, {}, &history).IsUsable());
    const double now = history.position[3 * tip[0] + 2] - model.body->mesh.nodes(2, tip[0]);
    if (last * now < 0) crossings.push_back(history.time - step * now / (now - last));
    last = now;
  }
  ASSERT_EQ(crossings.size(), 3u);
  const double frequency = 1 / (crossings[2] - crossings[0]);
  // Beam theory neglects that the clamp restrains lateral contraction, which changes about 1 %.
  EXPECT_NEAR(frequency, theory, 0.015 * theory) << "Euler–Bernoulli " << euler << " Hz";
}

TEST(Energy, DecreasesMonotonicallyWithImplicitEulerAndMuchLessWithBdf2) {
  const Model model = Bar("neo_hookean", {8, 2, 2}, 1, true);
  double remaining[2];
  int k = 0;
  for (const TimeScheme scheme : {TimeScheme::kImplicitEuler, TimeScheme::kBdf2}) {
    MotionHistory history = Swing(model);
    const double start = TotalEnergy(model, history);
    double last = start;
    Stepper stepper(model, {.scheme = scheme, .relative_tolerance = 1e-10});
    for (int step = 0; step < 200; ++step) {
      ASSERT_TRUE(stepper.Step(5e-3, {}, &history).IsUsable());
      const double now = TotalEnergy(model, history);
      if (scheme == TimeScheme::kImplicitEuler) {
        EXPECT_LE(now, last * (1 + 1e-9)) << "step " << step;
      }
      EXPECT_LE(now, start * (1 + 1e-9)) << "the energy must never exceed its initial value";
      last = now;
    }
    remaining[k++] = last / start;
  }
  // One second is two and a half periods of the first mode, whose energy implicit Euler reduces by
  // the factor exp(−ω² h t) = 0.28.
  EXPECT_LT(remaining[0], 0.35) << remaining[1];
  EXPECT_GT(remaining[1], 0.9);
}

TEST(Energy, OfADampedBodyDecaysAtTheRateOfRayleighDamping) {
  // With α alone, the amplitude of the first mode decays as exp(−α t/2) and its energy as exp(−α
  // t).
  Model model = Bar("linear", {10, 1, 1}, 2, true);
  model.effects.push_back(MakeEffect("mass_damping", {{"alpha", 4}}));
  MotionHistory history = RestHistory(model);
  const double beta = 1.875104 / kLength;
  Throw(
      model,
      [&](const Eigen::Vector3d& x) {
        const double z = beta * x[0];
        return Eigen::Vector3d(
            0, 0, 1e-3 * (std::cosh(z) - std::cos(z) - 0.734096 * (std::sinh(z) - std::sin(z))));
      },
      &history);
  const auto energy = [&](const MotionHistory& at) {
    const Model elastic{model.body, {model.effects[0]}, {}};
    return TotalEnergy(elastic, at);
  };
  const double start = energy(history);
  history = Moved(model, TimeScheme::kBdf2, 0.4, 800, history);
  // The tolerance covers the numerical damping of BDF2 and the small share of higher modes.
  EXPECT_NEAR(energy(history) / start, std::exp(-4 * 0.4), 0.02);
}

TEST(FreeFlight, ConservesMomentumAndKeepsTheShape) {
  for (const int order : {1, 2}) {
    Model model = Bar("corotational", {5, 2, 2}, order, false);
    model.effects.push_back(MakeEffect("gravity", {{"acceleration_z", -9.81}}));
    MotionHistory history = RestHistory(model);
    history = Moved(model, TimeScheme::kImplicitEuler, 0.1, 10, history);
    // n steps of implicit Euler give a fall of g h² n(n+1)/2.
    const double fall = 9.81 * 0.01 * 0.01 * 55;
    for (int i = 0; i < model.body->NodeCount(); ++i) {
      EXPECT_NEAR(history.position[3 * i + 2], model.body->mesh.nodes(2, i) - fall, 1e-10);
    }
  }
}

TEST(FreeFlight, RotatesWithoutSpuriousDamping) {
  // Stiffness-proportional damping must not slow down a rigid rotation of any size.
  Model model = Bar("neo_hookean", {5, 2, 2}, 1, false);
  model.effects.push_back(MakeEffect(
      "stiffness_damping", {{"beta", 0.01}, {"young_modulus", kYoung}, {"poisson_ratio", 0.3}}));
  MotionHistory history = RestHistory(model);
  const Eigen::Vector3d centre(kLength / 2, kSide / 2, kSide / 2), spin(0, 0, 6);
  Throw(
      model, [&](const Eigen::Vector3d& x) { return spin.cross(x - centre); }, &history);
  const double start = KineticEnergy(model, history);
  history = Moved(model, TimeScheme::kBdf2, 1.0, 1000, history);
  // BDF2 itself loses a term of order (ωh)³ per step; a force −βKv would stop the body in a few ms.
  EXPECT_GT(KineticEnergy(model, history), 0.99 * start);
  EXPECT_LT(KineticEnergy(model, history), 1.001 * start);
}

TEST(Grip, MovesTheBodyAndCarriesItsWeight) {
  // In a quasi-static motion at constant velocity the force of the grip is the weight.
  Model model = Bar("corotational", {8, 2, 2}, 1, true);
  model.effects.push_back(MakeEffect("gravity", {{"acceleration_z", -9.81}}));
  const Eigen::Matrix3Xd rest = model.body->mesh.nodes(Eigen::all, model.grips[0].nodes);
  model.grips[0].motion = [rest](double time) {
    return Eigen::Matrix3Xd(rest.colwise() + Eigen::Vector3d(0, 0.1 * time, 0));
  };
  MotionHistory history = RestHistory(model);
  Stepper stepper(model, {.scheme = TimeScheme::kQuasiStatic, .relative_tolerance = 1e-11});
  ASSERT_TRUE(stepper.Step(0.5, {}, &history).IsUsable());
  EXPECT_EQ(history.time, 0.5);
  EXPECT_NEAR(history.velocity[3 * model.grips[0].nodes[0] + 1], 0.1, 1e-12);
  const StepEquation equation(model, history, TimeScheme::kQuasiStatic, 0);
  Eigen::VectorXd force;
  equation.Residual(history.position, &force);
  Eigen::Vector3d total = Eigen::Vector3d::Zero();
  for (const int node : model.grips[0].nodes) total += force.segment<3>(3 * node);
  const double weight = kDensity * kLength * kSide * kSide * 9.81;
  EXPECT_LT((total - Eigen::Vector3d(0, 0, weight)).norm(), 1e-8 * weight);
}

TEST(StepEquation, HasTheResidualAsGradientOfItsPotentialAndTheTangentAsItsDerivative) {
  Model model = Bar("neo_hookean", {3, 1, 1}, 2, true);
  model.effects.push_back(MakeEffect("gravity", {{"acceleration_z", -9.81}}));
  for (const TimeScheme scheme :
       {TimeScheme::kQuasiStatic, TimeScheme::kImplicitEuler, TimeScheme::kBdf2}) {
    const MotionHistory history = Moved(model, TimeScheme::kBdf2, 0.02, 4, Swing(model));
    const StepEquation equation(model, history, scheme, 0.005);
    const Eigen::VectorXd direction =
        Eigen::VectorXd::LinSpaced(history.position.size(), -1, 2).array().sin();
    const Eigen::VectorXd at = history.position + 1e-4 * direction;
    Eigen::VectorXd residual, ahead, behind, product;
    equation.Residual(at, &residual);
    BlockMatrix tangent(model.body->pattern);
    equation.Tangent(at, false, &tangent);
    tangent.Multiply(direction, &product);
    const double h = 1e-6;
    equation.Residual(at + h * direction, &ahead);
    equation.Residual(at - h * direction, &behind);
    // Truncation (h/element size)² = 1e-8, and rounding 1e-16/1e-6 of forces that are 1e3 times
    // larger.
    EXPECT_LT((product - (ahead - behind) / (2 * h)).norm(), 1e-6 * product.norm());
    const double slope =
        (equation.Potential(at + h * direction) - equation.Potential(at - h * direction)) / (2 * h);
    EXPECT_NEAR(slope, residual.dot(direction), 1e-5 * std::abs(slope));
  }
}

TEST(StepEquation, HasTheNegativeParameterDerivativesOfItsResidual) {
  Model model = Bar("corotational", {3, 1, 1}, 1, true);
  model.effects.push_back(MakeEffect("mass_damping", {{"alpha", 3}}));
  const MotionHistory history = Moved(model, TimeScheme::kBdf2, 0.02, 4, Swing(model));
  const StepEquation equation(model, history, TimeScheme::kBdf2, 0.005);
  const auto residual = [&](int effect, const Eigen::VectorXd& values) {
    Model other = model;
    other.effects[effect] = model.effects[effect]->WithParameters(values);
    Eigen::VectorXd there;
    StepEquation(other, history, TimeScheme::kBdf2, 0.005).Residual(history.position, &there);
    return there;
  };
  for (int effect = 0; effect < 2; ++effect) {
    const Eigen::VectorXd values = model.effects[effect]->Parameters();
    for (int k = 0; k < values.size(); ++k) {
      Eigen::VectorXd force = Eigen::VectorXd::Zero(history.position.size());
      equation.AddParameterForce(equation.End(history.position), effect, k, &force);
      const double h = 1e-5 * values[k];
      const Eigen::VectorXd shift = h * Eigen::VectorXd::Unit(values.size(), k);
      const Eigen::VectorXd difference =
          (residual(effect, values + shift) - residual(effect, values - shift)) / (2 * h);
      EXPECT_GT(force.norm(), 0);
      EXPECT_LT((force + difference).norm(), 1e-7 * force.norm());
    }
  }
}

TEST(Stepper, DoesNotChangeTheHistoryWhenAStepFails) {
  const Model model = Bar("corotational", {3, 1, 1}, 1, true);
  Stepper stepper(model, {.max_iterations = 0});
  MotionHistory history = Swing(model);
  const MotionHistory before = history;
  const StepSummary summary = stepper.Step(0.01, {}, &history);
  EXPECT_EQ(summary.status, StepSummary::Status::kNoConvergence);
  EXPECT_NE(summary.message.find("0.01 s"), std::string::npos) << summary.message;
  EXPECT_EQ(history.time, before.time);
  EXPECT_EQ(history.position, before.position);
  const Eigen::VectorXd nan = Eigen::VectorXd::Constant(history.position.size(), std::nan(""));
  EXPECT_FALSE(Stepper(model, {}).Step(0.01, nan, &history).IsUsable());
}

}  // namespace
}  // namespace lacuna
