#include "core/random_bits.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>

namespace lacuna {
namespace {

TEST(RandomBits, AreUniformNormalAndFreeOfCorrelation) {
  constexpr int kCount = 100'000;
  double sum = 0, square = 0, lagged = 0, last = 0, uniform = 0;
  for (uint64_t i = 0; i < kCount; ++i) {
    const double x = Normal(RandomBits({7, 0, 0, i, 1}));
    sum += x, square += x * x, lagged += x * last;
    uniform += Uniform(RandomBits({7, 0, 0, i, 2}));
    last = x;
  }
  const double tolerance = 4 / std::sqrt(kCount);  // four standard errors
  EXPECT_NEAR(sum / kCount, 0, tolerance);
  EXPECT_NEAR(square / kCount, 1, tolerance * std::numbers::sqrt2);
  EXPECT_NEAR(lagged / kCount, 0, tolerance);
  EXPECT_NEAR(uniform / kCount, 0.5, tolerance / std::sqrt(12));
}

}  // namespace
}  // namespace lacuna
