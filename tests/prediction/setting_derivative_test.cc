// Derivatives by Poisson's ratios that are settings, of effects with and without memory.
#include "prediction/setting_derivative.h"

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "effects/catalogue.h"
#include "support/strained_body.h"

namespace lacuna {
namespace {

constexpr double kStepLength = 0.01;  // s

struct SettingCase {
  std::string type;
  std::map<std::string, double> parameters;  // without Poisson's ratio
};

class SettingDerivativeOf : public testing::TestWithParam<SettingCase> {
 protected:
  static std::shared_ptr<const Effect> Make(double ratio) {
    std::map<std::string, double> parameters = GetParam().parameters;
    parameters["poisson_ratio"] = ratio;
    return MakeEffect(GetParam().type, parameters);
  }
  // Stretched and sheared, then let go by half: what softens remembers the larger strain.
  static Eigen::VectorXd Place(const Body& body, double share) {
    const Eigen::Matrix3d gradient{{0.2, 0.05, 0}, {0, -0.06, 0.03}, {0.02, 0, -0.05}};
    const Eigen::Matrix3d F = Eigen::Matrix3d::Identity() + share * gradient;
    return (F * body.mesh.nodes).reshaped();
  }
  static Eigen::VectorXd ForceAtEnd(double ratio) {
    StrainedBody moved(Make(ratio));
    moved.Move(Place(moved.body(), 1), kStepLength);
    return moved.Move(Place(moved.body(), 0.5), kStepLength);
  }
};

TEST_P(SettingDerivativeOf, AgreesWithOtherRatiosAllTheWay) {
  constexpr double kRatio = 0.4, kDifference = 1e-4;
  const std::shared_ptr<const Effect> effect = Make(kRatio);
  const int setting = ParameterIndex(effect->Card(), "poisson_ratio");
  ASSERT_TRUE(effect->Card().parameters.at(static_cast<size_t>(setting)).setting);
  const Perturbation by_ratio = ParameterPerturbation(effect, setting);
  StrainedBody moved(by_ratio.effect);
  EXPECT_EQ(moved.Move(Place(moved.body(), 1), kStepLength).norm(), 0) << "it exerts no force";
  const Eigen::VectorXd position = Place(moved.body(), 0.5);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(position.size());
  Eigen::VectorXd derivative = zero;
  by_ratio.effect->AddParameterDerivative(
      {moved.body(), position, zero, zero, 0, kStepLength, moved.state()}, by_ratio.parameter,
      &derivative);
  const Eigen::VectorXd expected =
      (ForceAtEnd(kRatio + kDifference) - ForceAtEnd(kRatio - kDifference)) / (2 * kDifference);
  ASSERT_GT(expected.norm(), 0);
  // The differences are a thousandth of the distance to 0.5, where the force is singular.
  EXPECT_LT((derivative - expected).norm(), 1e-4 * expected.norm());
}

TEST_P(SettingDerivativeOf, LeavesOtherParametersToTheEffect) {
  const std::shared_ptr<const Effect> effect = Make(0.4);
  const Perturbation by_size = ParameterPerturbation(effect, 0);
  EXPECT_EQ(by_size.effect, effect);
  EXPECT_EQ(by_size.parameter, 0);
}

INSTANTIATE_TEST_SUITE_P(Effects, SettingDerivativeOf,
                         testing::Values(SettingCase{"viscoelastic_branch",
                                                     {{"modulus", 5e4}, {"relaxation_time", 0.03}}},
                                         SettingCase{"softening",
                                                     {{"modulus", 5e4}, {"softening_strain", 0.1}}},
                                         SettingCase{"inclusion",
                                                     {{"young_modulus_difference", 5e4},
                                                      {"centre_x", 0.02},
                                                      {"centre_y", 0.01},
                                                      {"centre_z", 0.01},
                                                      {"radius", 0.01}}},
                                         SettingCase{"stiffness_gradient",
                                                     {{"young_modulus_difference", 5e4},
                                                      {"axis_x", 1},
                                                      {"axis_y", 0},
                                                      {"axis_z", 0},
                                                      {"length", 0.04}}}),
                         [](const auto& info) { return info.param.type; });

}  // namespace
}  // namespace lacuna
