// The derivative of a followed motion by the moduli of its material, from the tangent-linear model
// along it (fem/tangent_linear.h). It exists where no forces are fitted.
//
// Fitted forces depend on the moduli. So do the correspondences that they are fitted to, because
// these are the nearest points of the scans and change as the body moves. A derivative through the
// forces with fixed correspondences does not agree with finite differences (docs/search.md).
#ifndef LACUNA_RECONSTRUCTION_FOLLOWED_SENSITIVITY_H_
#define LACUNA_RECONSTRUCTION_FOLLOWED_SENSITIVITY_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/tangent_linear.h"
#include "reconstruction/reconstruction_study.h"

namespace lacuna {

// Whether the derivative exists, which requires that there are no forces or that they are known.
bool HasModulusSensitivity(const ForceSettings& forces);

class FollowedSensitivity {
 public:
  // Differentiates by these parameters of the model's first effect.
  FollowedSensitivity(const Model& model, const std::vector<int>& parameters);

  // To be called after each step, which led from `before` to `position`.
  void Advance(const MotionHistory& before, TimeScheme scheme, double time_step,
               const Eigen::VectorXd& position);

  // dx/dθ at the end of the last step (3n × parameters); empty once a step could not be
  // differentiated.
  const Eigen::MatrixXd& position() const { return position_; }

 private:
  TangentLinear linear_;
  bool usable_ = true;
  Eigen::MatrixXd position_;
};

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_FOLLOWED_SENSITIVITY_H_
