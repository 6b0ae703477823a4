#include "analysis/normal_distribution.h"

#include <cmath>
#include <numbers>

namespace lacuna {
namespace {

// Below this Φ follows from its continued fraction. The complementary error function, which gives
// it above, underflows near −38.
constexpr double kTail = -30;

// φ(z) / Φ(z) for z < kTail, by the continued fraction of Laplace with x = −z (Abramowitz & Stegun,
// Handbook of Mathematical Functions, 1964, 26.2.14),
//   φ/Φ = x + 1/(x + 2/(x + 3/(x + …))),
// whose first ten terms leave an error far below the rounding of a double there.
double RatioInTail(double z) {
  constexpr int kTerms = 10;
  double ratio = -z;
  for (int k = kTerms; k > 0; --k) ratio = -z + k / ratio;
  return ratio;
}

}  // namespace

double LogNormal(double z) {
  if (z > 0) return std::log1p(-0.5 * std::erfc(z / std::numbers::sqrt2));
  if (z > kTail) return std::log(0.5 * std::erfc(-z / std::numbers::sqrt2));
  return -0.5 * z * z - 0.5 * std::log(2 * std::numbers::pi) - std::log(RatioInTail(z));
}

double LogTwiceNormal(double z) {
  if (z > kTail) return std::log(std::erfc(-z / std::numbers::sqrt2));
  return LogNormal(z) + std::numbers::ln2;
}

double InverseMillsRatio(double z) {
  if (z <= kTail) return RatioInTail(z);
  return std::exp(-0.5 * z * z) * std::sqrt(2 / std::numbers::pi) /
         std::erfc(-z / std::numbers::sqrt2);
}

}  // namespace lacuna
