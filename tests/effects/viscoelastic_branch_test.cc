#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <numbers>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/check_effect.h"
#include "support/strained_body.h"

namespace lacuna {
namespace {

constexpr double kModulus = 4e4;  // Pa
constexpr double kTau = 0.03;     // s

std::shared_ptr<const Effect> Branch(double modulus = kModulus, double tau = kTau,
                                     double poisson = 0) {
  return MakeEffect("viscoelastic_branch",
                    {{"modulus", modulus}, {"relaxation_time", tau}, {"poisson_ratio", poisson}});
}

TEST(ViscoelasticBranch, PassesTheEffectChecks) {
  CheckEffect(Branch(kModulus, kTau, 0.4).get());
  // A branch that has relaxed by 1 − 4e-5 at the end of the step.
  CheckEffect(Branch(kModulus, 0.001, 0.4).get());
}

TEST(ViscoelasticBranch, PassesTheEffectChecksForCrushedAndInvertedElements) {
  // Forces vary as the cube of such strains, which causes more truncation error.
  CheckEffect(Branch(kModulus, kTau, 0.4).get(), {.strain = 4, .tolerance = 1e-5});
}

TEST(ViscoelasticBranch, RelaxesExponentiallyInAHeldBar) {
  for (const int order : {1, 2}) {
    StrainedBody bar(Branch(), order);
    constexpr double kStrain = 0.3;
    // After a ramp of duration τ/3 in one step, 3 (1 − e^(−1/3)) of the stress of the spring
    // remains.
    double expected = kModulus * kStrain * 3 * (1 - std::exp(-1.0 / 3));
    EXPECT_NEAR(bar.StretchBranch(kStrain, kTau / 3), expected, 1e-10 * expected);
    for (const double hold : {0.2, 3.0, 0.01, 1.0}) {  // in τ; the update is exact: only rounding
      expected *= std::exp(-hold);
      EXPECT_NEAR(bar.StretchBranch(kStrain, hold * kTau), expected, 1e-10 * expected);
    }
  }
}

// Complex modulus over m at the angular frequency ω: Fourier coefficient of the fourth period.
std::complex<double> ComplexModulus(double omega_tau, int steps) {
  StrainedBody bar(Branch());
  constexpr double kStrain = 0.2;
  const double time_step = 2 * std::numbers::pi * kTau / omega_tau / steps;
  std::complex<double> sum = 0;
  for (int n = 1; n <= 4 * steps; ++n) {
    const double angle = 2 * std::numbers::pi * n / steps;
    const double stress = bar.StretchBranch(kStrain * std::sin(angle), time_step);
    if (n > 3 * steps) sum += stress * std::polar(1.0, -angle);
  }
  return sum * std::complex<double>(0, 2.0 / steps) / (kModulus * kStrain);
}

TEST(ViscoelasticBranch, HasTheStorageAndLossModulusOfAMaxwellElementToSecondOrder) {
  for (const double x : {0.3, 1.0, 3.0}) {
    const std::complex<double> exact(x * x / (1 + x * x), x / (1 + x * x));
    const double coarse = std::abs(ComplexModulus(x, 24) - exact);
    const double fine = std::abs(ComplexModulus(x, 48) - exact);
    const double finest = std::abs(ComplexModulus(x, 96) - exact);
    // The initial transient is e^(−6π/x) < 2e-3 after three periods at x = 3. It does not decrease
    // with the step and limits the finest error there.
    EXPECT_LT(finest, 3e-3) << x;
    if (x > 2) continue;
    // Second order: each halving divides the error by 4, up to higher orders.
    EXPECT_NEAR(std::log2(coarse / fine), 2, 0.1) << x;
    EXPECT_NEAR(std::log2(fine / finest), 2, 0.1) << x;
  }
}

TEST(ViscoelasticBranch, RelaxesInParallelWithAnElasticLawWithoutChangeOfShape) {
  // With the same Poisson ratio, and at a strain of 1e-4 that leaves all laws linear to 1e-3, a
  // clamped bar that is stretched and held has the force (E + m b e^(−t/τ))/E of the elastic one.
  constexpr double kYoung = 1e5, kLength = 0.06, kStretch = 1e-4 * kLength;
  const auto body =
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, {kLength, 0.02, 0.02}, {3, 1, 1}), 1000));
  std::vector<int> ends[2];
  for (int i = 0; i < body->NodeCount(); ++i) {
    if (body->mesh.nodes(0, i) < 1e-9) ends[0].push_back(i);
    if (body->mesh.nodes(0, i) > kLength - 1e-9) ends[1].push_back(i);
  }
  Grip fixed{Eigen::Map<Eigen::VectorXi>(ends[0].data(), ends[0].size()), {}};
  Grip pulled{Eigen::Map<Eigen::VectorXi>(ends[1].data(), ends[1].size()), {}};
  Eigen::Matrix3Xd held = body->mesh.nodes(Eigen::all, pulled.nodes);
  held.row(0).array() += kStretch;
  pulled.motion = [held](double) { return held; };
  const Model model{body,
                    {MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", 0.4}}),
                     Branch(kModulus, kTau, 0.4)},
                    {fixed, pulled}};
  Stepper stepper(model, {.scheme = TimeScheme::kQuasiStatic});
  MotionHistory history = RestHistory(model);
  const double time_step = 0.25 * kTau;
  const double gain = (1 - std::exp(-0.25)) / 0.25;
  double elastic = 0;
  for (int n = 0; n <= 16; ++n) {
    const MotionHistory before = history;
    const StepSummary summary = stepper.Step(time_step, {}, &history);
    ASSERT_TRUE(summary.IsUsable()) << summary.message;
    const StepEquation equation(model, before, TimeScheme::kQuasiStatic, time_step);
    Eigen::VectorXd residual;
    equation.Residual(history.position, &residual);
    double force = 0;
    for (const int i : ends[1]) force += residual[3 * i];
    const double share = kModulus * gain * std::exp(-0.25 * n) / kYoung;
    if (n == 0) elastic = force / (1 + share);
    EXPECT_NEAR(force / elastic, 1 + share, 1e-4) << n;
  }
  EXPECT_GT(elastic, 0.9 * kYoung * 1e-4 * 4e-4);
}

TEST(ViscoelasticBranch, BecomesKelvinVoigtWhenItsTimeVanishes) {
  // Q → m τ C : ΔB/h. At small strain B is E, here up to some 1e-3 of it, and the rate at the end
  // of a straight path differs from ΔE/h by a share of half the strain of the step.
  constexpr double kShort = 1e-6, kStep = 1e-3;
  StrainedBody body(Branch(kModulus, kShort, 0.3));
  const Eigen::Matrix3d F{{1.0002, 0.0001, 0}, {-0.0002, 0.9999, 0.0001}, {0.0001, 0, 1.0001}};
  const Eigen::Matrix3d change = 1e-5 * Eigen::Matrix3d{{1, 0, 2}, {-1, 1, 0}, {0, 1, -2}};
  body.Deform(F, kStep);
  const Eigen::VectorXd position = ((F + change) * body.body().mesh.nodes).reshaped();
  const Eigen::VectorXd velocity = (change * body.body().mesh.nodes).reshaped() / kStep;
  const Eigen::VectorXd force = body.Move(position, kStep);
  const auto damping = MakeEffect(
      "stiffness_damping", {{"beta", kShort}, {"young_modulus", kModulus}, {"poisson_ratio", 0.3}});
  const Eigen::VectorXd viscous = ForceAt(*damping, body.body(), position, velocity);
  EXPECT_LT((force - viscous).norm(), 1e-3 * viscous.norm());
}

TEST(ViscoelasticBranch, HasNoForceInStaticsAndNoMemory) {
  StrainedBody body(Branch());
  EXPECT_GT(body.StretchBranch(0.2, kTau), 0);
  EXPECT_EQ(body.StretchBranch(0.3, 0), 0);
  EXPECT_EQ(body.StretchBranch(0.3, kTau), 0);
}

TEST(ViscoelasticBranch, TakesItsPoissonRatioFromTheMaterial) {
  const auto material =
      MakeEffect("neo_hookean", {{"young_modulus", 7e4}, {"poisson_ratio", 0.42}});
  const Config config = Config::Parse(
      "type: viscoelastic_branch\nmodulus: 20 kPa\nrelaxation_time: 300 ms\n", "a.yaml");
  EXPECT_TRUE(
      MakeEffect(config, material.get())->Parameters().isApprox(Eigen::Vector3d(2e4, 0.3, 0.42)));
  EXPECT_THROW(MakeEffect(config), InputError);
}

}  // namespace
}  // namespace lacuna
