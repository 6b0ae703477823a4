// Properties of every effect that is an additional energy at each material point.
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "effects/catalogue.h"
#include "support/box_mesh.h"
#include "support/check_effect.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

struct Case {
  std::string type;
  std::map<std::string, double> parameters;
  bool either_sign = true;  // its size may be negative as well
};

class PointEnergy : public testing::TestWithParam<Case> {
 protected:
  std::shared_ptr<const Effect> Make(double scale) const {
    const auto effect = MakeEffect(GetParam().type, GetParam().parameters);
    Eigen::VectorXd values = effect->Parameters();
    values[0] *= scale;
    return effect->WithParameters(values);
  }
};

TEST_P(PointEnergy, PassesTheEffectChecks) { CheckEffect(Make(1).get()); }

TEST_P(PointEnergy, PassesTheEffectChecksForCrushedAndInvertedElements) {
  // Finite differences in strongly distorted elements need small steps, which causes more rounding.
  CheckEffect(Make(1).get(), {.strain = 4, .tolerance = 1e-5});
}

TEST_P(PointEnergy, PassesTheEffectChecksAtNegativeSize) {
  if (GetParam().either_sign) CheckEffect(Make(-1).get());
}

TEST_P(PointEnergy, IsProportionalToItsSize) {
  const OneElement element;
  const Eigen::Matrix3d F{{1.2, 0.3, -0.1}, {0.1, 0.8, 0.2}, {-0.2, 0.1, 0.9}};
  const Eigen::VectorXd position = element.Position(F);
  const auto present = Make(1), absent = Make(0);
  const Eigen::VectorXd force = element.Force(*present, F);
  Eigen::VectorXd derivative = Eigen::VectorXd::Zero(12);
  absent->AddParameterDerivative(
      {element.body, position, element.velocity, element.velocity, 0, 0, element.state}, 0,
      &derivative);
  ASSERT_GT(force.norm(), 0);
  EXPECT_LT((derivative * present->Parameters()[0] - force).norm(), 1e-12 * force.norm());
  EXPECT_EQ(element.Force(*absent, F).norm(), 0);
  EXPECT_EQ(element.Energy(*absent, F), 0);
}

INSTANTIATE_TEST_SUITE_P(
    All, PointEnergy,
    testing::Values(
        Case{"strain_stiffening", {{"modulus", 2e4}}, false},
        Case{"fibre_stiffness", {{"modulus", 5e4}, {"azimuth", 0.7}, {"inclination", -0.4}}},
        // At the edge of the block that CheckEffect uses.
        Case{"inclusion",
             {{"young_modulus_difference", 6e4},
              {"centre_x", 0.04},
              {"centre_y", -0.02},
              {"centre_z", 0.03},
              {"radius", 0.02},
              {"poisson_ratio", 0.4}}},
        Case{"stiffness_gradient",
             {{"young_modulus_difference", 6e4},
              {"origin_x", 0.02},
              {"axis_x", 1},
              {"axis_y", -0.5},
              {"axis_z", 0.3},
              {"length", 0.05},
              {"poisson_ratio", 0.4}}},
        Case{"active_contraction",
             {{"tension", 5e3}, {"axis_x", 1}, {"axis_y", -0.5}, {"axis_z", 0.3}}}),
    [](const auto& info) { return info.param.type; });

}  // namespace
}  // namespace lacuna
