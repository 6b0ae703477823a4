#include "analysis/normal_distribution.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace lacuna {
namespace {

// ln Φ and φ/Φ, made in Python with the module decimal and 70 digits: from the series of Φ for
// |z| < 8, φ(z) Σ z²ᵏ⁺¹/(1·3·…·(2k + 1)) + ½, and from 60 or more terms of the continued fraction
// of (1 − Φ)/φ beyond. The thirtieth standard deviation is where the method changes.
struct NormalValues {
  double z, log_normal, inverse_mills_ratio;
};
constexpr NormalValues kNormalValues[] = {
    {-1e6, -500000000014.73444909, 1000000.000001},
    {-1000, -500007.82669481218431, 1000.00099999800001},
    {-50, -1254.8313611394199013, 50.019984031905639809},
    {-38.5, -745.69527029041108133, 38.525939096854493696},
    {-30.125, -458.08320531527955298, 30.158122264738872321},
    {-29.875, -450.57489035082954732, 29.908398212334331827},
    {-20.125, -206.43116783908300388, 20.174447045575577535},
    {-5, -15.064998393988725736, 5.1865039671258421156},
    {-1.5, -2.705944400823889807, 1.9386771666225431895},
    {-0.75, -1.484448229919656292, 1.3287779652212070407},
    {0, -0.69314718055994530942, 0.79788456080286535588},
    {0.25, -0.51298407540943043213, 0.64583937101681726584},
    {1, -0.17275377902344988953, 0.28759997093917836123},
    {4, -0.00003167174337748926386, 0.00013383446446857514211},
    {9, -1.1285884059538406478e-19, 1.0279773571668914796e-18},
    {20, -2.7536241186062336951e-89, 5.5209483621597631896e-88},
    {37, -5.7255712225245768227e-300, 2.1200065515246056269e-298},
};

TEST(LogNormal, IsAccurateFromTailToTail) {
  for (const NormalValues& at : kNormalValues)
    EXPECT_NEAR(LogNormal(at.z), at.log_normal, 1e-12 * std::abs(at.log_normal)) << at.z;
}

TEST(LogTwiceNormal, IsLargerByTheLogarithmOfTwo) {
  for (const NormalValues& at : kNormalValues) {
    const double expected = at.log_normal + std::log(2);
    EXPECT_NEAR(LogTwiceNormal(at.z), expected, 1e-12 * std::max(1e-3, std::abs(expected))) << at.z;
  }
}

// From the decimal values of ln Φ + ln 2.
TEST(LogTwiceNormal, VanishesWhereHalfTheAmountsArePositive) {
  EXPECT_EQ(LogTwiceNormal(0), 0);
  EXPECT_NEAR(LogTwiceNormal(-0.125), -0.10477896219307878082, 1e-15);
  EXPECT_NEAR(LogTwiceNormal(-1e-5), -0.0000079788774390536074924, 1e-15);
  EXPECT_NEAR(LogTwiceNormal(1e-9), 7.9788456048455546973e-10, 1e-15);
}

TEST(InverseMillsRatio, IsAccurateFromTailToTail) {
  for (const NormalValues& at : kNormalValues)
    EXPECT_NEAR(InverseMillsRatio(at.z), at.inverse_mills_ratio, 1e-12 * at.inverse_mills_ratio)
        << at.z;
}

TEST(LogNormal, HasItsLimits) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(LogNormal(-kInfinity), -kInfinity);
  EXPECT_EQ(LogNormal(kInfinity), 0);
  EXPECT_EQ(LogTwiceNormal(kInfinity), std::log(2));
  EXPECT_EQ(InverseMillsRatio(kInfinity), 0);
}

}  // namespace
}  // namespace lacuna
