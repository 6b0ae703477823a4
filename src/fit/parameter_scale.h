// θ and what is searched for in its place: φ = ln θ on a logarithmic scale, θ otherwise.
#ifndef LACUNA_FIT_PARAMETER_SCALE_H_
#define LACUNA_FIT_PARAMETER_SCALE_H_

#include <cmath>

#include "fit/calibration.h"

namespace lacuna {

inline double ToFree(const CalibratedParameter& parameter, double value) {
  return parameter.log_scale ? std::log(value) : value;
}

inline double FromFree(const CalibratedParameter& parameter, double free) {
  return parameter.log_scale ? std::exp(free) : free;
}

inline double PriorMeanOf(const CalibratedParameter& parameter) {
  return std::isnan(parameter.prior_mean) ? parameter.start : parameter.prior_mean;
}

}  // namespace lacuna

#endif  // LACUNA_FIT_PARAMETER_SCALE_H_
