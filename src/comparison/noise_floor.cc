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

// The measured places (3m × n, m), those of each marker multiplied by one factor that gives them
// the noise `sigma`: the root of the mean of (σ / σ of the marker)² over the frames.
Eigen::MatrixXd TracksOfEqualNoise(const RecordedResiduals& residuals, double sigma) {
  Eigen::MatrixXd tracks = residuals.measured;
  for (Eigen::Index m = 0; m < residuals.sigma.rows(); ++m) {
    const double factor = Rms(sigma * residuals.sigma.row(m).cwiseInverse());
    if (!std::isnan(factor)) tracks.middleRows<3>(3 * m) *= factor;
  }
  return tracks;
}

}  // namespace

NoiseFloor MeasureNoiseFloor(const RecordedResiduals& residuals, double sigma) {
  const Eigen::MatrixXd tracks = TracksOfEqualNoise(residuals, sigma);
  NoiseFloor result;
  result.white = WhiteNoise(tracks);
  const bool has_white_part = !std::isnan(result.white) && result.white != 0;
  const double noise = has_white_part ? result.white : sigma;
  // The distance between two measurements of one place has the rms √6 σ.
  const std::vector<StaticSpan> rests = StaticSpans(
      residuals.times, tracks, kRestThreshold * std::sqrt(6.0) * noise, kFewestFramesAtRest);
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
