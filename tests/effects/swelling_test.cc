#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "effects/catalogue.h"
#include "fem/stepper.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

constexpr double kYoung = 8e4;  // Pa
constexpr double kPoisson = 0.4;

std::shared_ptr<const Effect> SwellingBy(double strain) {
  return MakeEffect("swelling", {{"strain", strain}});
}

std::shared_ptr<const Effect> Law(const std::string& type) {
  return MakeEffect(type, {{"young_modulus", kYoung}, {"poisson_ratio", kPoisson}});
}

class SwellingOfLaw : public testing::TestWithParam<std::string> {};
INSTANTIATE_TEST_SUITE_P(Laws, SwellingOfLaw,
                         testing::Values("linear", "corotational", "st_venant_kirchhoff",
                                         "neo_hookean"),
                         [](const auto& info) { return info.param; });

// The linear law is not the same in a turned frame, as the card promises for the others; what
// CheckEffect examines besides follows in the tests below.
TEST(Swelling, PassesTheEffectChecks) {
  for (const char* type : {"corotational", "st_venant_kirchhoff", "neo_hookean"}) {
    const auto law = Law(type);
    for (const double strain : {0.1, -0.05})
      CheckEffect(SwellingBy(strain).get(), {.elasticity = law.get()});
  }
}

TEST_P(SwellingOfLaw, HasItsDerivativeAtNoSwelling) {
  OneElement element;
  const auto law = Law(GetParam());
  element.elasticity = law.get();
  const Eigen::Matrix3d F{{1.05, 0.02, -0.01}, {0.03, 0.97, 0.02}, {0, -0.02, 1.01}};
  const Eigen::VectorXd position = element.Position(F);
  for (const double strain : {0.0, 0.04}) {
    EXPECT_EQ(element.Force(*SwellingBy(0), F).norm(), 0) << "exactly the model without it";
    Eigen::VectorXd derivative = Eigen::VectorXd::Zero(12);
    SwellingBy(strain)->AddParameterDerivative({element.body, position, element.velocity,
                                                element.velocity, 0, 0, element.state, law.get()},
                                               0, &derivative);
    constexpr double kStep = 1e-5;
    const Eigen::VectorXd difference = (element.Force(*SwellingBy(strain + kStep), F) -
                                        element.Force(*SwellingBy(strain - kStep), F)) /
                                       (2 * kStep);
    // Truncation is of the order of the step squared; rounding 1e-16/1e-5.
    EXPECT_LT((derivative - difference).norm(), 1e-8 * derivative.norm()) << strain;
  }
}

// To first order in the strain the thermal stress of small-strain elasticity.
TEST_P(SwellingOfLaw, PushesWithTheThermalStressOfABodyHeldOnAllSides) {
  OneElement element;
  const auto law = Law(GetParam());
  element.elasticity = law.get();
  for (const double strain : {1e-5, -1e-5}) {
    const Eigen::Matrix3d expected =
        -kYoung * strain / (1 - 2 * kPoisson) * Eigen::Matrix3d::Identity();
    EXPECT_LT((element.Stress(*SwellingBy(strain), Eigen::Matrix3d::Identity()) - expected).norm(),
              1e-4 * expected.norm());
  }
}

// A body that is larger in all directions by ε stores (1 + ε)³ times the energy at the elastic
// part.
TEST_P(SwellingOfLaw, StoresTheEnergyOfTheElasticPart) {
  OneElement element;
  const auto law = Law(GetParam());
  element.elasticity = law.get();
  const Eigen::Matrix3d F{{1.1, 0.05, 0}, {-0.02, 1.03, 0.1}, {0.01, 0, 0.95}};
  for (const double strain : {0.08, -0.05}) {
    const double whole = element.Energy(*law, F) + element.Energy(*SwellingBy(strain), F);
    EXPECT_NEAR(whole, std::pow(1 + strain, 3) * element.Energy(*law, F / (1 + strain)),
                1e-12 * whole);
  }
}

TEST_P(SwellingOfLaw, EnlargesAFreeBodyByItsStrain) {
  for (const double strain : {0.001, 0.08, -0.05}) {
    const double stretch = 1 + strain;
    for (const int order : {1, 2}) {
      const TetMesh mesh = BoxMesh({0, 0, 0}, {0.04, 0.02, 0.02}, {4, 2, 2}, order);
      Model model{std::make_shared<const Body>(MakeBody(mesh, 1000)),
                  {Law(GetParam()), SwellingBy(strain)},
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

TEST(Swelling, IsAFreeStrainInYaml) {
  const auto material = Law("corotational");
  const Config config = Config::Parse("type: swelling\nstrain: -2 %\n", "a.yaml");
  EXPECT_EQ(MakeEffect(config, material.get())->Parameters(), Eigen::VectorXd::Constant(1, -0.02));
  EXPECT_EQ(MakeEffect(config)->Parameters(), Eigen::VectorXd::Constant(1, -0.02));
}

TEST(Swelling, NoLongerHasModuliOfItsOwn) {
  const Config config =
      Config::Parse("type: swelling\nstrain: 2 %\nyoung_modulus: 70 kPa\n", "a.yaml");
  try {
    MakeEffect(config);
    FAIL() << "the modulus was accepted";
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), testing::HasSubstr("a.yaml:3:"));
    EXPECT_THAT(error.what(), testing::HasSubstr("young_modulus"));
    EXPECT_THAT(error.what(), testing::HasSubstr("no longer needed"));
  }
}

}  // namespace
}  // namespace lacuna
