#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/check_effect.h"
#include "support/strained_body.h"

namespace lacuna {
namespace {

constexpr double kModulus = 6e4;  // Pa
constexpr double kYield = 0.05;

std::shared_ptr<const Effect> Branch(double modulus = kModulus, double yield = kYield) {
  return MakeEffect("elastoplastic_branch", {{"modulus", modulus}, {"yield_strain", yield}});
}

// Difference of the axial and the lateral second Piola–Kirchhoff stress in a bar of the axial
// Green–Lagrange strain E₁₁ = ε and the lateral −ε/2, at which dev E = ε diag(1, −½, −½).
double BarStress(StrainedBody* bar, double strain) {
  const Eigen::Vector3d stretch(std::sqrt(1 + 2 * strain), std::sqrt(1 - strain),
                                std::sqrt(1 - strain));
  const Eigen::Matrix3d P = bar->Deform(stretch.asDiagonal(), 0);
  return P(0, 0) / stretch[0] - P(1, 1) / stretch[1];
}

TEST(ElastoplasticBranch, PassesTheEffectChecks) {
  // At strains of 0.05 to 0.1 some points are elastic and others yield.
  CheckEffect(Branch().get());
  CheckEffect(Branch(kModulus, 0.01).get());
}

TEST(ElastoplasticBranch, PassesTheEffectChecksForCrushedAndInvertedElements) {
  // Forces vary as the cube of such strains, which causes more truncation error.
  CheckEffect(Branch().get(), {.strain = 4, .tolerance = 1e-5});
}

TEST(ElastoplasticBranch, FollowsPrandtlsLoop) {
  for (const int order : {1, 2}) {
    StrainedBody bar(Branch(), order);
    constexpr double kAmplitude = 0.2;
    double slider = 0, strain = 0, stress = 0, area = 0;
    // Loading and two cycles. The stress depends on the path only, not on the size of the steps.
    for (const double target : {kAmplitude, -kAmplitude, kAmplitude, -kAmplitude, kAmplitude}) {
      const double from = strain;
      const double corner = slider + std::copysign(kYield, target - from);
      std::vector<double> stops{corner, target};
      for (const double fraction : {0.13, 0.4, 0.77}) {
        stops.push_back(from + fraction * (target - from));
      }
      std::sort(stops.begin(), stops.end());
      if (target < from) std::reverse(stops.begin(), stops.end());
      for (const double next : stops) {
        slider = std::clamp(slider, next - kYield, next + kYield);
        const double expected = kModulus * (next - slider);
        const double got = BarStress(&bar, next);
        // Rounding of strains (1e-16) and of sums.
        EXPECT_NEAR(got, expected, 1e-10 * kModulus * kYield) << next;
        area += 0.5 * (stress + got) * (next - strain);
        strain = next;
        stress = got;
      }
    }
    // The work of loading is ½ m ε_y² + m ε_y (a − ε_y), that of each loop 4 m ε_y (a − ε_y).
    const double flow = kModulus * kYield * (kAmplitude - kYield);
    EXPECT_NEAR(area, 0.5 * kModulus * kYield * kYield + 9 * flow, 1e-9 * flow);
  }
}

TEST(ElastoplasticBranch, LeavesThePermanentSetOfTheClosedForm) {
  // A bar of bulk modulus K and shear modulus G in parallel with a branch of shear modulus m/3 that
  // yields at σ_y = m ε_y is loaded by σ and released: the shear strain rises to (σ − σ_y)/(3G) and
  // recovers by σ/(3G + m). At strains of 1e-4 strain measures differ by a share of 1e-4.
  constexpr double kYoung = 1e5, kPoisson = 0.35, kSmallYield = 5e-5;
  constexpr double kBulk = kYoung / (3 * (1 - 2 * kPoisson));
  constexpr double kThreeShear = 3 * kYoung / (2 * (1 + kPoisson));
  StrainedBody branch(Branch(kModulus, kSmallYield));
  StrainedBody spring(
      MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", kPoisson}}));
  const double sigma_y = kModulus * kSmallYield, sigma = 4 * sigma_y;
  // The strain at which the sum of both stresses is the uniaxial `load`, by Newton's method with
  // difference quotients; the memory advances at the solution only.
  const auto draw = [&](double load) {
    Eigen::Vector2d strain = Eigen::Vector2d::Zero();  // axial, lateral
    const auto imbalance = [&](const Eigen::Vector2d& at) {
      StrainedBody trial = branch;
      const Eigen::Matrix3d F = Eigen::Vector3d(1 + at[0], 1 + at[1], 1 + at[1]).asDiagonal();
      const Eigen::Matrix3d P = trial.Deform(F, 0) + spring.Deform(F, 0);
      return Eigen::Vector2d(P(0, 0) - load, P(1, 1));
    };
    for (int iteration = 0; iteration < 50; ++iteration) {
      Eigen::Matrix2d slope;
      constexpr double kStep = 1e-9;
      for (const int k : {0, 1}) {
        const Eigen::Vector2d shift = kStep * Eigen::Vector2d::Unit(k);
        slope.col(k) = (imbalance(strain + shift) - imbalance(strain - shift)) / (2 * kStep);
      }
      strain -= slope.partialPivLu().solve(imbalance(strain));
    }
    EXPECT_LT(imbalance(strain).norm(), 1e-6 * sigma_y);
    branch.Deform(Eigen::Vector3d(1 + strain[0], 1 + strain[1], 1 + strain[1]).asDiagonal(), 0);
    return strain[0];
  };
  const double loaded = sigma / (9 * kBulk) + (sigma - sigma_y) / kThreeShear;
  const double set = (sigma - sigma_y) / kThreeShear - sigma / (kThreeShear + kModulus);
  EXPECT_NEAR(draw(sigma), loaded, 1e-3 * loaded);
  EXPECT_NEAR(draw(0), set, 1e-3 * set);
  EXPECT_GT(set, 0.1 * loaded);
}

TEST(ElastoplasticBranch, KeepsABentBarBent) {
  // Statics, solved by Newton's method with the consistent tangent: loaded, unloaded and loaded
  // again below the first load, where nothing flows any more.
  const auto body =
      std::make_shared<Body>(MakeBody(BoxMesh({0, 0, 0}, {0.1, 0.02, 0.02}, {5, 1, 1}, 2), 1000));
  std::vector<int> fixed;
  int tip = 0;
  for (int i = 0; i < body->NodeCount(); ++i) {
    if (body->mesh.nodes(0, i) < 1e-9) fixed.push_back(i);
    if (body->mesh.nodes.col(i).sum() > body->mesh.nodes.col(tip).sum()) tip = i;
  }
  const Model model{body,
                    {MakeEffect("neo_hookean", {{"young_modulus", 1e5}, {"poisson_ratio", 0.4}}),
                     Branch(kModulus, 0.01)},
                    {{Eigen::Map<Eigen::VectorXi>(fixed.data(), fixed.size()), {}}}};
  Stepper stepper(model, {});
  MotionHistory history = RestHistory(model);
  const auto deflection = [&](double load) {
    const Eigen::VectorXd force =
        load * Eigen::Vector3d(0, 0, -1).replicate(body->NodeCount(), 1) / body->NodeCount();
    const StepSummary summary = stepper.Equilibrium(force, &history);
    EXPECT_TRUE(summary.IsUsable()) << summary.message;
    EXPECT_LE(summary.iterations, 15);
    return body->mesh.nodes(2, tip) - history.position[3 * tip + 2];
  };
  const double first = deflection(0.4);
  const double set = deflection(0);
  const double again = deflection(0.4);
  EXPECT_GT(set, 0.05 * first);
  EXPECT_LT(set, 0.9 * first);
  // The same load finds the same shape: to the solver's tolerance of 1e-8 of all forces, in a
  // slender bar.
  EXPECT_NEAR(again, first, 1e-4 * first);
}

}  // namespace
}  // namespace lacuna
