#include "fem/time_scheme.h"

#include <cmath>

namespace lacuna {
namespace {

// ρ of the two-step scheme. A value closer to 1 reduces the error but damps shocks more slowly.
constexpr double kRadius = 0.6;
constexpr double kBeta = 2 / ((1 + kRadius) * (3 - kRadius));
constexpr double kAlpha = 4 * kBeta * (1 + kRadius) - 4;
// Steps whose lengths differ by less than this fraction count as equally long.
constexpr double kSameLength = 1e-6;

}  // namespace

int OrderOf(TimeScheme scheme) {
  return scheme == TimeScheme::kQuasiStatic || scheme == TimeScheme::kImplicitEuler ? 1 : 2;
}

SchemeWeights WeightsOf(TimeScheme scheme, double h, int steps_before, double last) {
  const double ratio = last > 0 ? h / last : 1;
  SchemeWeights weights;
  weights.rate = 1 / h;
  if (steps_before == 0) return weights;
  if (scheme == TimeScheme::kBdf2) {
    weights.rate = (1 + 2 * ratio) / (1 + ratio) / h;
    weights.now = (1 + ratio) * (1 + ratio) / (1 + 2 * ratio);
    weights.before = -ratio * ratio / (1 + 2 * ratio);
  } else if (scheme == TimeScheme::kTwoStep) {
    if (steps_before > 1 && std::abs(ratio - 1) < kSameLength) {
      weights = {.rate = 1 / (kBeta * h),
                 .now = -kAlpha,
                 .before = 1 + kAlpha,
                 .rate_now = 2 * kRadius * kBeta * h,
                 .rate_before = kRadius * kRadius * kBeta * h};
    } else {
      weights.rate = 2 / h;
      weights.rate_now = 0.5 * h;
    }
  }
  return weights;
}

}  // namespace lacuna
