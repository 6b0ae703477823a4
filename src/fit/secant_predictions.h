// Predictions with exact Jacobians, or with Jacobians updated by secants.
//
// While secants are followed, the Jacobian J at a new point is the previous one changed by
// Broyden's update (Math. Comp. 19, 1965), J + (y − J s) sᵀ/(sᵀ s), where s is the change of the
// parameters in units of their typical changes and y the change of the residual. This is the
// smallest change of J that reproduces y. Parameters marked as linear are excluded from s.
#ifndef LACUNA_FIT_SECANT_PREDICTIONS_H_
#define LACUNA_FIT_SECANT_PREDICTIONS_H_

#include <Eigen/Core>
#include <vector>

#include "fit/calibrated_parameter.h"
#include "fit/prediction_function.h"

namespace lacuna {

// Caches the latest prediction, because an optimiser often asks for the same point several times in
// succession: as a trial, as the solution and as the next start. Keeps references to the function
// and the parameters, which must outlive it. Not thread-safe.
class SecantPredictions {
 public:
  SecantPredictions(const PredictionFunction& predict,
                    const std::vector<CalibratedParameter>& parameters)
      : predict_(predict), parameters_(parameters) {}

  // The prediction at `values` (θ, SI), with an updated Jacobian while secants are followed and
  // with the exact one otherwise. The reference is valid until the next call.
  const Prediction& At(const Eigen::VectorXd& values);
  // The same, always with the exact Jacobian.
  const Prediction& ExactAt(const Eigen::VectorXd& values);
  // The residual only. The result is not cached.
  Prediction WithoutJacobianAt(const Eigen::VectorXd& values) {
    ++count_;
    return predict_(values, /*with_jacobian=*/false);
  }
  // Switches secants on or off. At least one exact prediction must precede the first secant.
  void FollowSecants(bool follows) { follows_secants_ = follows; }
  int count() const { return count_; }  // evaluations of the function so far

 private:
  struct Known {
    Eigen::VectorXd values;
    Prediction prediction;
  };

  void FollowTo(const Eigen::VectorXd& values);

  const PredictionFunction& predict_;
  const std::vector<CalibratedParameter>& parameters_;
  bool follows_secants_ = false, is_exact_ = false;
  Eigen::VectorXd values_;
  Prediction prediction_;
  Known known_;  // the latest usable prediction
  int count_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_FIT_SECANT_PREDICTIONS_H_
