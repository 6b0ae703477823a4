#include "effects/radial_return.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

namespace lacuna {
namespace {

using Vector6 = Eigen::Vector<double, 6>;

// A vector of length 5 and a limit of half that: 3, 4 and 5 make all results exact.
const Eigen::Vector3d kTrial(3, 4, 0);
constexpr double kLimit = 2.5;

TEST(RadialReturn, KeepsWhatIsWithinTheLimit) {
  EXPECT_EQ(RadialReturn(kTrial, 5), kTrial);
  EXPECT_EQ(RadialReturnDerivative(kTrial, 5), Eigen::Matrix3d::Identity());
  EXPECT_EQ(RadialReturn<3>(Eigen::Vector3d::Zero(), 5), Eigen::Vector3d(0, 0, 0));
}

TEST(RadialReturn, LeadsBackToTheLimitAlongTheTrialValue) {
  EXPECT_EQ(RadialReturn(kTrial, kLimit), Eigen::Vector3d(1.5, 2, 0));
}

// ½ (I − n nᵀ) with n = (0.6, 0.8, 0): nothing along the trial value, half of the rest.
TEST(RadialReturn, HasTheDerivativeOfAProjectionOntoASphere) {
  const Eigen::Matrix3d expected{{0.32, -0.24, 0}, {-0.24, 0.18, 0}, {0, 0, 0.5}};
  EXPECT_LT((RadialReturnDerivative(kTrial, kLimit) - expected).norm(), 1e-15);
  const Eigen::Vector3d change(1, -2, 3);
  EXPECT_LT((RadialReturnChange(kTrial, kLimit, change) - expected * change).norm(), 1e-15);
}

// A bar at constant volume, sheared and stretched beyond yield: its deviatoric stress
// s = 2μ r(x), 2μ = 2m/3, keeps its direction, and its von Mises stress √(3/2) ‖s‖ is the yield
// stress m ε_y at any strain.
TEST(RadialReturn, LimitsTheVonMisesStress) {
  const double yield_strain = 0.02, modulus = 3e4, shear = 0.05;
  for (const double stretch : {0.03, 0.3}) {
    // diag(1, −½, −½) stretch, and E₁₂ = shear, in Kelvin's notation.
    Vector6 strain;
    strain << stretch, -stretch / 2, -stretch / 2, 0, 0, std::sqrt(2) * shear;
    const Vector6 stress = 2 * modulus / 3 * RadialReturn(strain, std::sqrt(1.5) * yield_strain);
    const double shear_stress = stress[5] / std::sqrt(2);
    const double von_mises =
        std::sqrt(0.5 * (std::pow(stress[0] - stress[1], 2) + std::pow(stress[1] - stress[2], 2) +
                         std::pow(stress[2] - stress[0], 2)) +
                  3 * shear_stress * shear_stress);
    EXPECT_NEAR(von_mises, modulus * yield_strain, 1e-12 * modulus);
    EXPECT_NEAR(shear_stress / stress[0], shear / stretch, 1e-14);
  }
}

// In six dimensions and off the axes, against central differences.
TEST(RadialReturn, ChangesAsItsDerivativeSays) {
  Vector6 trial, change;
  trial << 0.3, -0.1, -0.2, 0.05, 0.4, -0.15;
  change << 0.2, 0.1, -0.3, 0.25, -0.1, 0.4;
  constexpr double kStep = 1e-5, kSmallLimit = 0.2;
  const Vector6 ahead = trial + kStep * change, behind = trial - kStep * change;
  const Vector6 difference =
      (RadialReturn(ahead, kSmallLimit) - RadialReturn(behind, kSmallLimit)) / (2 * kStep);
  // The truncation error of the difference is of the order of kStep².
  EXPECT_LT((RadialReturnChange(trial, kSmallLimit, change) - difference).norm(), 1e-9);
  EXPECT_LT((RadialReturnDerivative(trial, kSmallLimit) * change - difference).norm(), 1e-9);
}

}  // namespace
}  // namespace lacuna
