// The steps of a search for parameters: within their bounds, not longer than a model of the cost
// can be trusted, and of least cost among those.
//
// A step is a change of the free values φ (calibrated_parameter.h) of parameters with the values θ.
#ifndef LACUNA_FIT_BOUNDED_STEPS_H_
#define LACUNA_FIT_BOUNDED_STEPS_H_

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "fit/active_bounds.h"
#include "fit/calibrated_parameter.h"

namespace lacuna {

class BoundedSteps {
 public:
  // `parameters` must outlive the object.
  explicit BoundedSteps(const std::vector<CalibratedParameter>& parameters);

  // The step from `values` that minimises the model and is not longer than `radius` (LengthOf):
  // that of the model with λ diag H added to its information H, for the least λ ≥ 0 that makes it
  // short enough.
  Eigen::VectorXd Step(const QuadraticCost& model, const Eigen::VectorXd& values,
                       double radius) const;

  // The step from `values` with each component that is too long made shorter.
  Eigen::VectorXd Limited(const Eigen::VectorXd& step, const Eigen::VectorXd& values) const;

  // The values after a step from `values`. A step that ends at a bound gives the bound itself.
  Eigen::VectorXd Moved(const Eigen::VectorXd& step, const Eigen::VectorXd& values) const;

  // The largest component of a step, in typical changes of the parameters.
  double LargestChange(const Eigen::VectorXd& step) const;

  // The length of a step relative to the curvature of each parameter alone, ‖√(diag H) step‖.
  static double LengthOf(const Eigen::VectorXd& step, const QuadraticCost& model);

 private:
  const CalibratedParameter& parameter(Eigen::Index k) const {
    return parameters_[static_cast<size_t>(k)];
  }
  // The least and the largest step of each φ from `values`, in typical changes.
  std::pair<Eigen::VectorXd, Eigen::VectorXd> Room(const Eigen::VectorXd& values) const;
  Eigen::VectorXd DampedStep(const QuadraticCost& model, const Eigen::VectorXd& values,
                             double damping) const;

  const std::vector<CalibratedParameter>& parameters_;
  Eigen::VectorXd typical_, low_, high_;  // typical changes and bounds of φ
};

}  // namespace lacuna

#endif  // LACUNA_FIT_BOUNDED_STEPS_H_
