#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "effects/catalogue.h"
#include "fem/simulate.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

constexpr double kYoung = 8e4;  // Pa
constexpr double kPoisson = 0.4;

std::shared_ptr<const Effect> SwellingBy(double strain) {
  return MakeEffect("swelling",
                    {{"strain", strain}, {"young_modulus", kYoung}, {"poisson_ratio", kPoisson}});
}

TEST(Swelling, PushesWithTheThermalStressOfABodyHeldOnAllSides) {
  const OneElement element;
  for (const double strain : {0.03, -0.02}) {
    const Eigen::Matrix3d expected =
        -kYoung * strain / (1 - 2 * kPoisson) * Eigen::Matrix3d::Identity();
    EXPECT_LT((element.Stress(*SwellingBy(strain), Eigen::Matrix3d::Identity()) - expected).norm(),
              1e-12 * expected.norm());
  }
}

// The stretch at which a free neo-Hookean body is without stress: μ s + ((λ + μ)(s³ − 1) − μ) s² is
// the principal stress, and 3 K ε s² the swelling stress.
double FreeStretch(double strain) {
  const double mu = kYoung / (2 * (1 + kPoisson));
  const double lambda = kYoung * kPoisson / ((1 + kPoisson) * (1 - 2 * kPoisson));
  const double push = kYoung * strain / (1 - 2 * kPoisson);
  double low = 0.5, high = 2;
  for (int k = 0; k < 100; ++k) {
    const double s = 0.5 * (low + high);
    (mu * s + ((lambda + mu) * (s * s * s - 1) - mu - push) * s * s < 0 ? low : high) = s;
  }
  return low;
}

TEST(Swelling, EnlargesAFreeBodyByItsStrain) {
  for (const double strain : {0.001, 0.08, -0.05}) {
    const double stretch = FreeStretch(strain);
    EXPECT_NEAR(stretch, 1 + strain, 2 * strain * strain) << "to first order";
    for (const int order : {1, 2}) {
      const TetMesh mesh = BoxMesh({0, 0, 0}, {0.04, 0.02, 0.02}, {4, 2, 2}, order);
      Model model{
          std::make_shared<const Body>(MakeBody(mesh, 1000)),
          {MakeEffect("neo_hookean", {{"young_modulus", kYoung}, {"poisson_ratio", kPoisson}}),
           SwellingBy(strain)},
          {}};
      // A grip that grows with the body keeps it in place.
      const Eigen::VectorXi held =
          NodesWhere(mesh, [](const Eigen::Vector3d& x) { return x[0] == 0; });
      const Eigen::Matrix3Xd places = stretch * mesh.nodes(Eigen::all, held);
      model.grips.push_back({held, [places](double) { return places; }});
      MotionHistory history = RestHistory(model);
      const StepSummary summary =
          Stepper(model, {.relative_tolerance = 1e-11}).Equilibrium({}, &history);
      ASSERT_TRUE(summary.IsUsable()) << summary.message;
      // Forces are solved to this tolerance.
      EXPECT_LT((history.position - stretch * mesh.nodes.reshaped()).norm(),
                1e-8 * mesh.nodes.norm())
          << strain << ", order " << order;
    }
  }
}

TEST(Swelling, ActsOnTheBoundaryOnly) {
  const Body body = MakeBody(BoxMesh({0, 0, 0}, {0.04, 0.04, 0.04}, {3, 3, 3}), 1000);
  Eigen::VectorXd position = body.mesh.nodes.reshaped();
  for (Eigen::Index k = 0; k < position.size(); ++k) position[k] += 0.003 * std::sin(7.0 * k);
  const Eigen::VectorXd force = ForceAt(*SwellingBy(0.05), body, position, 0 * position);
  int inside = 0;
  for (int i = 0; i < body.NodeCount(); ++i) {
    if (std::find(body.boundary.node.begin(), body.boundary.node.end(), i) !=
        body.boundary.node.end()) {
      continue;
    }
    ++inside;
    // Rounding of sums over some 24 elements.
    EXPECT_LT(force.segment<3>(3 * i).norm(), 1e-13 * force.norm());
  }
  EXPECT_EQ(inside, 8);
  EXPECT_GT(force.norm(), 0);
}

TEST(Swelling, TakesItsModuliFromTheMaterial) {
  const auto material =
      MakeEffect("corotational", {{"young_modulus", 7e4}, {"poisson_ratio", 0.42}});
  const Config config = Config::Parse("type: swelling\nstrain: -2 %\n", "a.yaml");
  EXPECT_TRUE(
      MakeEffect(config, material.get())->Parameters().isApprox(Eigen::Vector3d(-0.02, 7e4, 0.42)));
  EXPECT_THROW(MakeEffect(config), InputError);
}

}  // namespace
}  // namespace lacuna
