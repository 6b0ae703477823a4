#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "effects/catalogue.h"
#include "support/check_effect.h"
#include "support/strained_body.h"

namespace lacuna {
namespace {

constexpr double kModulus = 6e4;  // Pa
constexpr double kHalf = 0.1;

std::shared_ptr<const Effect> Branch(double modulus = kModulus, double poisson = 0.4) {
  return MakeEffect(
      "softening", {{"modulus", modulus}, {"softening_strain", kHalf}, {"poisson_ratio", poisson}});
}

TEST(Softening, PassesTheEffectChecks) { CheckEffect(Branch().get()); }

TEST(Softening, PassesTheEffectChecksForCrushedAndInvertedElements) {
  // Forces vary as the cube of such strains, which causes more truncation error.
  CheckEffect(Branch().get(), {.strain = 4, .tolerance = 1e-5});
}

TEST(Softening, SoftensOnFirstLoadingOnly) {
  for (const int order : {1, 2}) {
    StrainedBody bar(Branch(kModulus, 0), order);
    double largest = 0;  // κ of a bar without lateral effect
    for (const double strain : {0.05, 0.2, 0.1, 0.0, 0.15, 0.2, 0.4, 0.3, -0.1, -0.3, 0.4, 0.5}) {
      largest = std::max(largest, std::abs(strain));
      const double expected = kModulus * strain / (1 + largest / kHalf);
      // Rounding of strains (1e-16) and of sums.
      EXPECT_NEAR(bar.StretchBranch(strain, 0), expected, 1e-10 * kModulus * kHalf) << strain;
    }
  }
}

TEST(Softening, DissipatesTheEnergyOfTheDamageOnce) {
  // A cycle to strain a and back: ∫ m κ g dκ − ½ m a² g(a), by a trapezoidal rule of error ~
  // steps⁻².
  StrainedBody bar(Branch(kModulus, 0));
  constexpr double kFar = 0.3;
  constexpr int kSteps = 1000;
  const double first = kModulus * kHalf * (kFar - kHalf * std::log1p(kFar / kHalf)) -
                       0.5 * kModulus * kFar * kFar / (1 + kFar / kHalf);
  for (const double expected : {first, 0.0, 0.0}) {
    double work = 0, before = 0;
    for (int n = 1; n <= 2 * kSteps; ++n) {
      const double now = bar.StretchBranch(kFar * std::min(n, 2 * kSteps - n) / kSteps, 0);
      work += 0.5 * (before + now) * (n <= kSteps ? kFar : -kFar) / kSteps;
      before = now;
    }
    EXPECT_NEAR(work, expected, 1e-5 * first);
  }
}

}  // namespace
}  // namespace lacuna
