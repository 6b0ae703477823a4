#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "effects/catalogue.h"
#include "support/one_element.h"

namespace lacuna {
namespace {

constexpr double kModulus = 3e3;  // Pa

TEST(StrainStiffening, IsYeohsSecondTermWhereTheVolumeIsKept) {
  // Uniaxial tension or compression of an incompressible bar: nominal stress
  // 4 c (I₁ − 3)(s − 1/s²), whatever pressure keeps the volume.
  const OneElement element;
  const auto stiffening = MakeEffect("strain_stiffening", {{"modulus", kModulus}});
  for (const double s : {0.4, 0.8, 1.1, 2.0, 4.0}) {
    const double lateral = 1 / std::sqrt(s);
    const Eigen::Matrix3d F = Eigen::Vector3d(s, lateral, lateral).asDiagonal();
    const Eigen::Matrix3d stress = element.Stress(*stiffening, F);
    const double nominal = stress(0, 0) - stress(1, 1) * lateral / s;
    const double invariant = s * s + 2 / s - 3;
    const double expected = 4 * kModulus * invariant * (s - 1 / (s * s));
    EXPECT_NEAR(nominal, expected, 1e-12 * std::abs(expected) + 1e-11) << s;
    EXPECT_NEAR(element.Energy(*stiffening, F) / element.body.weight.sum(),
                kModulus * invariant * invariant, 1e-11 * kModulus)
        << s;
  }
}

TEST(StrainStiffening, DoublesTheForceOfRubberAtTwiceTheLengthWithAnEighthOfItsShearModulus) {
  // As the card says; with ν = 0.49 rather than ½ only volume-keeping stretches are compared.
  const OneElement element;
  const Eigen::Matrix3d F = Eigen::Vector3d(2, std::sqrt(0.5), std::sqrt(0.5)).asDiagonal();
  const auto nominal = [&](const Effect& effect) {
    const Eigen::Matrix3d stress = element.Stress(effect, F);
    return stress(0, 0) - stress(1, 1) * F(1, 1) / F(0, 0);
  };
  const auto rubber = MakeEffect(
      "neo_hookean", {{"young_modulus", 2 * 1.49 * 8 * kModulus}, {"poisson_ratio", 0.49}});
  const auto stiffening = MakeEffect("strain_stiffening", {{"modulus", kModulus}});
  EXPECT_NEAR(nominal(*stiffening), nominal(*rubber), 1e-10 * kModulus);
}

TEST(StrainStiffening, DoesNotChangeTheModuliAtSmallStrain) {
  // Stress grows as the cube of the strain: 2c · 2 e:e · 4 e.
  const OneElement element;
  const auto stiffening = MakeEffect("strain_stiffening", {{"modulus", kModulus}});
  Eigen::Matrix3d strain{{1.0, 0.4, -0.3}, {0.4, -0.7, 0.2}, {-0.3, 0.2, 0.5}};
  strain *= 1e-4;
  const Eigen::Matrix3d deviator = strain - strain.trace() / 3 * Eigen::Matrix3d::Identity();
  const Eigen::Matrix3d expected = 16 * kModulus * deviator.squaredNorm() * deviator;
  // The next order in the strain is smaller by a few times 1e-4.
  EXPECT_LT((element.Stress(*stiffening, Eigen::Matrix3d::Identity() + strain) - expected).norm(),
            1e-3 * expected.norm());
}

TEST(StrainStiffening, RefusesANegativeModulus) {
  EXPECT_THROW(MakeEffect(Config::Parse("type: strain_stiffening\nmodulus: -1 kPa\n", "a.yaml")),
               InputError);
}

}  // namespace
}  // namespace lacuna
