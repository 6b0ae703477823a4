#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "effects/catalogue.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

constexpr double kModulus = 4e4;  // Pa
constexpr double kAzimuth = 30 * std::numbers::pi / 180, kInclination = 20 * std::numbers::pi / 180;

std::shared_ptr<const Effect> Fibres(double azimuth, double inclination) {
  return MakeEffect("fibre_stiffness",
                    {{"modulus", kModulus}, {"azimuth", azimuth}, {"inclination", inclination}});
}

TEST(FibreStiffness, ResistsStretchOfTheFibresOnly) {
  const OneElement element;
  const auto fibres = Fibres(kAzimuth, kInclination);
  const Eigen::Vector3d a(std::cos(kInclination) * std::cos(kAzimuth),
                          std::cos(kInclination) * std::sin(kAzimuth), std::sin(kInclination));
  const Eigen::Vector3d b = a.unitOrthogonal();
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  for (const double s : {0.5, 1.2, 2.0}) {
    const Eigen::Matrix3d expected = kModulus / 2 * (s * s - 1) * s * a * a.transpose();
    const Eigen::Matrix3d along = element.Stress(*fibres, identity + (s - 1) * a * a.transpose());
    EXPECT_LT((along - expected).norm(), 1e-12 * expected.norm()) << s;
  }
  // Stretch across them and shear that slides them along each other; to rounding.
  for (const Eigen::Vector3d& direction : {a, b}) {
    const Eigen::Matrix3d F = identity + 0.4 * direction * b.transpose();
    EXPECT_LT(element.Stress(*fibres, F).norm(), 1e-14 * kModulus);
  }
}

TEST(FibreStiffness, IsTheTransverselyIsotropicSolidOfSmallStrain) {
  // Adding k a⊗a⊗a⊗a to an isotropic stiffness changes its compliance by Sherman & Morrison's
  // formula: along the fibres Young's modulus is E + k, and a pull askew to them shears.
  constexpr double kYoung = 1e5, kPoisson = 0.3;
  const OneElement element;
  const auto solid = MakeEffect("linear", {{"young_modulus", kYoung}, {"poisson_ratio", kPoisson}});
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const auto isotropic = [&](const Eigen::Matrix3d& stress) {
    return Eigen::Matrix3d(((1 + kPoisson) * stress - kPoisson * stress.trace() * identity) /
                           kYoung);
  };
  const Eigen::Matrix3d pull = 1e-7 * kYoung * Eigen::Vector3d(1, 0, 0).asDiagonal();
  for (const double degrees : {0.0, 35.0, 90.0}) {
    const double azimuth = degrees * std::numbers::pi / 180;
    const Eigen::Vector3d a(std::cos(azimuth), std::sin(azimuth), 0);
    const double along = a.dot(isotropic(pull) * a);
    const Eigen::Matrix3d strain =
        isotropic(pull) - kModulus * along / (1 + kModulus / kYoung) * isotropic(a * a.transpose());
    if (degrees == 0) {
      EXPECT_NEAR(strain(0, 0), pull(0, 0) / (kYoung + kModulus), 1e-18);
    }
    if (degrees == 35) {
      EXPECT_GT(std::abs(strain(0, 1)), 0.05 * strain(0, 0));
    }
    const Eigen::Matrix3d stress = element.Stress(*solid, identity + strain) +
                                   element.Stress(*Fibres(azimuth, 0), identity + strain);
    // The next order in the strain is smaller by 1e-7.
    EXPECT_LT((stress - pull).norm(), 1e-6 * pull.norm()) << degrees;
  }
}

TEST(FibreStiffness, IsReadFromYaml) {
  const Config config = Config::Parse(
      "type: fibre_stiffness\nmodulus: -5 kPa\nazimuth: 90 deg\ninclination: 0.1 rad\n", "a.yaml");
  EXPECT_LT(
      (MakeEffect(config)->Parameters() - Eigen::Vector3d(-5e3, std::numbers::pi / 2, 0.1)).norm(),
      1e-12);
  config.RefuseUnknownKeys();
}

}  // namespace
}  // namespace lacuna
