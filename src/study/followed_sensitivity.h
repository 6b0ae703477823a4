// How a followed motion changes with the moduli of its material, the forces fitted anew included.
//
// Per step, with s = ∂x/∂θ under unchanged force coefficients (fem/tangent_linear.h, which carries
// what earlier steps have changed) and R = ∂x/∂c (fit/force_response.h),
//   dx/dθ = s + R dc/dθ,
// where dc/dθ keeps the fit's own condition. That condition is not the search's objective: the fit
// minimises whitened squares, step by step, so that forces answer to θ to first order in |D| and
// the envelope theorem does not remove them.
#ifndef LACUNA_STUDY_FOLLOWED_SENSITIVITY_H_
#define LACUNA_STUDY_FOLLOWED_SENSITIVITY_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "fem/tangent_linear.h"
#include "fit/force_model.h"
#include "fit/observations.h"
#include "study/reconstruction.h"

namespace lacuna {

// Forces that are fitted at each node, or whose expected size is a share of Young's modulus, answer
// in ways that are not followed here.
bool HasModulusSensitivity(const ForceSettings& forces);

class FollowedSensitivity {
 public:
  // By these parameters of the model's first effect. The force model must outlive it.
  FollowedSensitivity(const Model& model, const ForceModel& forces,
                      const std::vector<int>& parameters);

  // The step from `before` to `position` has been taken; `seen` is what its forces were fitted to,
  // null where none were.
  void Advance(const MotionHistory& before, TimeScheme scheme, double time_step,
               const Eigen::VectorXd& position, const Observations* seen, double robust_threshold);

  // dx/dθ at the end of the last step (3n × parameters); empty once a step could not be
  // differentiated, which `message` tells.
  const Eigen::MatrixXd& position() const { return position_; }
  const std::string& message() const { return message_; }

 private:
  const Model& model_;
  const ForceModel& forces_;
  TangentLinear linear_;
  Eigen::MatrixXd position_;
  std::string message_;
};

}  // namespace lacuna

#endif  // LACUNA_STUDY_FOLLOWED_SENSITIVITY_H_
