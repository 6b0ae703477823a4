#include "comparison/noise_floor.h"

#include <cmath>
#include <utility>
#include <vector>

#include "analysis/residual_statistics.h"
#include "core/median.h"

namespace lacuna {
namespace {

constexpr int kFewestFramesAtRest = 10;
// The markers rest while they stay within this many standard deviations of the distance between two
// measurements of one place. Noise alone rarely exceeds it.
constexpr double kRestThreshold = 2;

}  // namespace

NoiseFloor MeasureNoiseFloor(const RecordedResiduals& residuals, double sigma) {
  NoiseFloor result;
  result.white = WhiteNoise(residuals.measured);
  const bool has_white_part = !std::isnan(result.white) && result.white != 0;
  const double noise = has_white_part ? result.white : sigma;
  // The distance between two measurements of one place has the rms √6 σ.
  const std::vector<StaticSpan> rests =
      StaticSpans(residuals.times, residuals.measured, kRestThreshold * std::sqrt(6.0) * noise,
                  kFewestFramesAtRest);
  std::vector<double> deviations;
  for (const StaticSpan& rest : rests) {
    result.rests.push_back({residuals.times[rest.first], residuals.times[rest.last], rest.deviation,
                            rest.drift, rest.noise_drift});
    if (!std::isnan(rest.deviation)) deviations.push_back(rest.deviation);
  }
  if (!deviations.empty()) result.rest_deviation = Median(std::move(deviations));
  result.floor = std::fmax(result.white, result.rest_deviation);
  return result;
}

}  // namespace lacuna
