// One unknown of a calibration: its start, bounds, scale and prior.
//
// The fit works with φ, which is ln θ for a parameter θ on a logarithmic scale and θ itself
// otherwise. Prior deviations and typical changes are therefore in units of φ (dimensionless on a
// logarithmic scale), while the start, the bounds and the prior mean are values of θ in SI.
#ifndef LACUNA_FIT_CALIBRATED_PARAMETER_H_
#define LACUNA_FIT_CALIBRATED_PARAMETER_H_

#include <cmath>
#include <limits>
#include <string>

#include "core/bounds.h"

namespace lacuna {

struct CalibratedParameter {
  std::string name;  // name in messages and records, e.g. "material.young_modulus"
  double start = 0;  // SI
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
  // The model degenerates at the bound, as an elastic body does at a Poisson's ratio of 0.5. A step
  // of the fit then leaves a part of the way to it.
  bool open_min = false, open_max = false;
  bool log_scale = false;  // φ = ln θ; `min` must be ≥ 0
  // The prior is Gaussian in φ. A mean of NaN means `start`; an infinite deviation means no prior.
  double prior_mean = std::numeric_limits<double>::quiet_NaN();  // SI
  double prior_deviation = std::numeric_limits<double>::infinity();
  // Nobody has given the prior: it follows from the range that the card of the effect calls
  // plausible. The fit does not depend on this; what is said about a conflict does.
  bool has_default_prior = false;
  // A change of φ that would matter to the user, > 0. The fit scales the parameter by it, and the
  // verdict kFlat compares the uncertainty with it.
  double typical = 1;
};

// Limits a parameter, whose start must be set, to [min, max] within the bounds of its card. A fit
// may reach a bound that lies inside an open one of the card. A bound very close to the open one,
// such as `lacuna add` writes, does not count: the model nearly degenerates there too.
inline void SetBounds(double min, double max, const Bounds& of_card,
                      CalibratedParameter* parameter) {
  // As a fraction of the distance of the start. With a larger value, more bounds stay open.
  constexpr double kClose = 1e-3;
  const auto is_close = [&](double bound, double open) {
    return std::abs(bound - open) <= kClose * std::abs(parameter->start - open);
  };
  parameter->min = min;
  parameter->max = max;
  parameter->open_min = of_card.open_min && is_close(min, of_card.min);
  parameter->open_max = of_card.open_max && is_close(max, of_card.max);
}

// φ of a value θ. On a logarithmic scale the value must be positive.
inline double ToFree(const CalibratedParameter& parameter, double value) {
  return parameter.log_scale ? std::log(value) : value;
}

// The value θ that belongs to φ; the inverse of ToFree.
inline double FromFree(const CalibratedParameter& parameter, double free) {
  return parameter.log_scale ? std::exp(free) : free;
}

// The mean of the prior as a value θ, SI; the start where no mean was given.
inline double PriorMeanOf(const CalibratedParameter& parameter) {
  return std::isnan(parameter.prior_mean) ? parameter.start : parameter.prior_mean;
}

}  // namespace lacuna

#endif  // LACUNA_FIT_CALIBRATED_PARAMETER_H_
