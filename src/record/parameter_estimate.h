// The estimate of one calibrated parameter: its value, uncertainty and identifiability.
//
// φ is the parameter θ itself, or ln θ for a parameter on a logarithmic scale.
#ifndef LACUNA_RECORD_PARAMETER_ESTIMATE_H_
#define LACUNA_RECORD_PARAMETER_ESTIMATE_H_

#include <cmath>
#include <limits>
#include <string>

namespace lacuna {

// kPinnedDown: the data determine the parameter. kDead: the predictions do not depend on it. kFlat:
// they do, but the effect of a typical change is within the noise. kTradedOff: changes of other
// parameters can compensate for its changes. kAtBound: the best value lies on a bound, so that the
// interval has little meaning.
enum class Determination { kPinnedDown, kDead, kFlat, kTradedOff, kAtBound };

struct ParameterEstimate {
  double value = 0;  // θ, SI
  // Standard deviations of φ with all other parameters free: from the data alone, and from data and
  // priors together. Infinite where the data do not determine the parameter.
  double deviation = std::numeric_limits<double>::infinity();
  double posterior_deviation = std::numeric_limits<double>::infinity();
  // 95 % interval of θ, SI. It includes the prior and, after WidenIntervalByModelErrors
  // (fit/calibration.h), known errors of the model, for which it may have another centre than
  // `value`.
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  Determination determination = Determination::kPinnedDown;
  std::string traded_with;  // name of the parameter with the strongest posterior correlation
  double correlation = 0;   // that correlation, −1 to 1
};

// The signed distance of the value `other` from the estimate, in posterior standard deviations of
// φ. If the deviation is 0, the distance is 0 for an equal value and infinite otherwise.
inline double DeviationsTo(double other, const ParameterEstimate& estimate, bool log_scale) {
  const double change =
      log_scale && other > 0 ? std::log(other / estimate.value) : other - estimate.value;
  if (estimate.posterior_deviation > 0) return change / estimate.posterior_deviation;
  return change == 0 ? 0 : std::copysign(std::numeric_limits<double>::infinity(), change);
}

}  // namespace lacuna

#endif  // LACUNA_RECORD_PARAMETER_ESTIMATE_H_
