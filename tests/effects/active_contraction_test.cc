#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "effects/catalogue.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

std::shared_ptr<const Effect> Contraction(double tension) {
  return MakeEffect("active_contraction", {{"tension", tension},
                                           {"axis_x", 3},
                                           {"axis_y", 0},
                                           {"axis_z", 4},
                                           {"start", 0.2},
                                           {"rise", 0.4}});
}

TEST(ActiveContraction, PullsAlongItsMaterialDirection) {
  OneElement element;
  element.time = 1;
  const Eigen::Vector3d a(0.6, 0, 0.8);
  const Eigen::Matrix3d F{{1.2, 0.3, -0.1}, {0.1, 0.8, 0.2}, {-0.2, 0.1, 0.9}};
  const Eigen::Matrix3d expected = 2e3 * F * a * a.transpose();
  EXPECT_LT((element.Stress(*Contraction(2e3), F) - expected).norm(), 1e-12 * expected.norm());
  // Zero at rest up to rounding; 2 kPa in 2.5 cm³ would be 5 mJ.
  EXPECT_NEAR(element.Energy(*Contraction(2e3), Eigen::Matrix3d::Identity()), 0, 1e-17);
}

TEST(ActiveContraction, ShortensABodyAndThickensIt) {
  // A free body of Young's modulus E: strain −T/E along the direction, ν T/E across.
  constexpr double kYoung = 1e5, kPoisson = 0.3, kTension = 1e-7 * kYoung;
  OneElement element;
  element.time = 1;
  const Eigen::Vector3d a(0.6, 0, 0.8);
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d F =
      identity + kTension / kYoung * (kPoisson * identity - (1 + kPoisson) * a * a.transpose());
  const auto solid = MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", kPoisson}});
  // The next order in the strain is smaller by 1e-7.
  EXPECT_LT((element.Stress(*solid, F) + element.Stress(*Contraction(kTension), F)).norm(),
            1e-6 * kTension);
  EXPECT_GT(element.Stress(*Contraction(kTension), F).norm(), 0.9 * kTension);
}

TEST(ActiveContraction, RisesSmoothlyFromItsStart) {
  OneElement element;
  const auto pull = [&](double time) {
    element.time = time;
    return element.Stress(*Contraction(1e3), Eigen::Matrix3d::Identity()).norm();
  };
  EXPECT_EQ(pull(0), 0);
  EXPECT_EQ(pull(0.2), 0);
  // u² (3 − 2u) at a quarter, a half and three quarters of the rise, up to rounding.
  EXPECT_NEAR(pull(0.3), 1e3 * 0.15625, 1e-9);
  EXPECT_NEAR(pull(0.4), 1e3 * 0.5, 1e-9);
  EXPECT_NEAR(pull(0.5), 1e3 * 0.84375, 1e-9);
  EXPECT_NEAR(pull(0.6), 1e3, 1e-9);
  EXPECT_NEAR(pull(9), 1e3, 1e-9);
}

TEST(ActiveContraction, IsReadFromYamlAndActsAtOnceByDefault) {
  const Config config = Config::Parse(
      "effects:\n"
      "  - {type: active_contraction, tension: -2 kPa, axis: [0, 1, 0]}\n"
      "  - {type: active_contraction, tension: 1 kPa, axis: [0, 0, 0]}\n",
      "a.yaml");
  const std::vector<Config> items = config.Items("effects");
  const auto contraction = MakeEffect(items[0]);
  Eigen::VectorXd values(6);
  values << -2e3, 0, 1, 0, 0, 0;
  EXPECT_LT((contraction->Parameters() - values).norm(), 1e-10);
  const OneElement element;
  const Eigen::Matrix3d stress = element.Stress(*contraction, Eigen::Matrix3d::Identity());
  EXPECT_NEAR(stress(1, 1), -2e3, 1e-9);
  EXPECT_THROW(MakeEffect(items[1]), InputError);
}

}  // namespace
}  // namespace lacuna
