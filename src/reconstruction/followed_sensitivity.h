// How a motion that follows a recording changes with the moduli of its material, where no forces
// are fitted: the tangent-linear model along it (fem/tangent_linear.h).
//
// Forces that are fitted answer to the moduli, and so do the correspondences that they are fitted
// to: nearest points of scans, taken anew from where the body has come to. A derivative through the
// forces with correspondences held did not agree with differences (docs/search.md).
#ifndef LACUNA_RECONSTRUCTION_FOLLOWED_SENSITIVITY_H_
#define LACUNA_RECONSTRUCTION_FOLLOWED_SENSITIVITY_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/tangent_linear.h"
#include "reconstruction/reconstruction_study.h"

namespace lacuna {

// No forces, or known ones.
bool HasModulusSensitivity(const ForceSettings& forces);

class FollowedSensitivity {
 public:
  // By these parameters of the model's first effect.
  FollowedSensitivity(const Model& model, const std::vector<int>& parameters);

  // The step from `before` to `position` has been taken.
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
