#include "fit/bounded_steps.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna {
namespace {

// A step changes no parameter by more than this many typical changes: far outside of the region
// that the data determine, a simulation takes long or fails.
constexpr double kLongestStep = 100;
// Nor does it change a parameter on a logarithmic scale by more than a factor of e. Where a time or
// a place has little influence yet, as that of an effect that is still small, the model would move
// it to the other end of its range for a small gain. Farther away,
// the derivative by the logarithm says little. A smaller value costs more steps from a start that
// is several times too large or too small.
constexpr double kLongestLogStep = 1;
// The largest part of the way to an open bound that a step takes. The linearised model knows
// nothing of what happens at the bound, and predictions there may take tens of times longer.
constexpr double kOfWayToOpenBound = 0.8;

}  // namespace

BoundedSteps::BoundedSteps(const std::vector<CalibratedParameter>& parameters)
    : parameters_(parameters),
      typical_(static_cast<Eigen::Index>(parameters.size())),
      low_(typical_.size()),
      high_(typical_.size()) {
  for (Eigen::Index k = 0; k < typical_.size(); ++k) {
    const CalibratedParameter& at = parameter(k);
    typical_[k] = at.typical;
    low_[k] =
        at.log_scale && at.min <= 0 ? -std::numeric_limits<double>::infinity() : ToFree(at, at.min);
    high_[k] = ToFree(at, at.max);
  }
}

Eigen::VectorXd BoundedSteps::Step(const QuadraticCost& model, const Eigen::VectorXd& values,
                                   double radius) const {
  Eigen::VectorXd step = DampedStep(model, values, 0);
  if (!(LengthOf(step, model) > radius)) return step;
  double low = -8, high = 8;  // of log10 λ
  while (high - low > 0.05) {
    const double middle = 0.5 * (low + high);
    step = DampedStep(model, values, std::pow(10, middle));
    (LengthOf(step, model) > radius ? low : high) = middle;
  }
  return DampedStep(model, values, std::pow(10, high));
}

Eigen::VectorXd BoundedSteps::Limited(const Eigen::VectorXd& step,
                                      const Eigen::VectorXd& values) const {
  const auto [low, high] = Room(values);
  return step.cwiseMax(typical_.cwiseProduct(low)).cwiseMin(typical_.cwiseProduct(high));
}

Eigen::VectorXd BoundedSteps::Moved(const Eigen::VectorXd& step,
                                    const Eigen::VectorXd& values) const {
  Eigen::VectorXd moved(values.size());
  for (Eigen::Index k = 0; k < moved.size(); ++k) {
    const CalibratedParameter& at = parameter(k);
    const double there = ToFree(at, values[k]) + step[k];
    const double at_bound = 1e-12 * std::max(at.typical, std::abs(there));
    moved[k] = there - low_[k] <= at_bound    ? at.min
               : high_[k] - there <= at_bound ? at.max
                                              : FromFree(at, there);
  }
  return moved;
}

double BoundedSteps::LargestChange(const Eigen::VectorXd& step) const {
  return step.cwiseQuotient(typical_).lpNorm<Eigen::Infinity>();
}

double BoundedSteps::LengthOf(const Eigen::VectorXd& step, const QuadraticCost& model) {
  return step.cwiseProduct(model.information.diagonal().cwiseSqrt()).norm();
}

std::pair<Eigen::VectorXd, Eigen::VectorXd> BoundedSteps::Room(
    const Eigen::VectorXd& values) const {
  Eigen::VectorXd low(values.size()), high(values.size());
  for (Eigen::Index k = 0; k < values.size(); ++k) {
    const CalibratedParameter& at = parameter(k);
    const double here = ToFree(at, values[k]);
    const double down = (at.open_min ? kOfWayToOpenBound : 1) * (low_[k] - here);
    const double up = (at.open_max ? kOfWayToOpenBound : 1) * (high_[k] - here);
    const double longest = at.log_scale ? kLongestLogStep / typical_[k] : kLongestStep;
    low[k] = std::clamp(down / typical_[k], -longest, 0.0);
    high[k] = std::clamp(up / typical_[k], 0.0, longest);
  }
  return {low, high};
}

Eigen::VectorXd BoundedSteps::DampedStep(const QuadraticCost& model, const Eigen::VectorXd& values,
                                         double damping) const {
  // In units of the typical changes, in which directions without influence are distinguished from
  // others.
  QuadraticCost scaled{model.cost, typical_.cwiseProduct(model.gradient),
                       typical_.asDiagonal() * model.information * typical_.asDiagonal()};
  scaled.information.diagonal() *= 1 + damping;
  const auto [low, high] = Room(values);
  return typical_.cwiseProduct(StepWithin(scaled, low, high));
}

}  // namespace lacuna
