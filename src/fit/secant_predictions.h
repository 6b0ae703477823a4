// Predictions with their Jacobians, exact or made of secants (Broyden, Math. Comp. 19, 1965).
#ifndef LACUNA_FIT_SECANT_PREDICTIONS_H_
#define LACUNA_FIT_SECANT_PREDICTIONS_H_

#include <Eigen/Core>
#include <vector>

#include "fit/calibration.h"

namespace lacuna {

// Keeps the last one: a point is asked for as a start, as a trial and as the solution, often the
// same one twice running. What it is made from must outlive it.
class SecantPredictions {
 public:
  SecantPredictions(const PredictionFunction& predict,
                    const std::vector<CalibratedParameter>& parameters)
      : predict_(predict), parameters_(parameters) {}

  // With the exact Jacobian, or, while secants are followed, with what they make of the last one.
  const Prediction& At(const Eigen::VectorXd& values);
  const Prediction& ExactAt(const Eigen::VectorXd& values);
  // Not kept.
  Prediction WithoutJacobianAt(const Eigen::VectorXd& values) {
    ++count_;
    return predict_(values, /*with_jacobian=*/false);
  }
  void FollowSecants(bool follows) { follows_secants_ = follows; }
  int count() const { return count_; }  // of calls of the function

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
  Known known_;  // the last usable one
  int count_ = 0;
};

}  // namespace lacuna

#endif  // LACUNA_FIT_SECANT_PREDICTIONS_H_
