#include "fit/secant_predictions.h"

namespace lacuna {

const Prediction& SecantPredictions::At(const Eigen::VectorXd& values) {
  if (!follows_secants_) return ExactAt(values);
  if (values != values_) FollowTo(values);
  return prediction_;
}

const Prediction& SecantPredictions::ExactAt(const Eigen::VectorXd& values) {
  if (count_ > 0 && is_exact_ && values == values_) return prediction_;
  ++count_;
  is_exact_ = true;
  prediction_ = predict_(values, /*with_jacobian=*/values.size() > 0);
  values_ = values;
  if (prediction_.usable) known_ = {values, prediction_};
  return prediction_;
}

void SecantPredictions::FollowTo(const Eigen::VectorXd& values) {
  // Below this sᵀ s the change of the residual would consist of rounding errors.
  constexpr double kNoChange = 1e-12;
  ++count_;
  is_exact_ = false;
  prediction_ = predict_(values, /*with_jacobian=*/false);
  values_ = values;
  if (!prediction_.usable) return;
  const Eigen::VectorXd change = values - known_.values;
  Eigen::VectorXd along = change;
  for (size_t k = 0; k < parameters_.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    const double unit = parameters_[k].typical * (parameters_[k].log_scale ? values[at] : 1);
    along[at] *= parameters_[k].is_linear ? 0 : 1 / (unit * unit);
  }
  prediction_.jacobian = known_.prediction.jacobian;
  const double square = along.dot(change);
  if (square > kNoChange)
    prediction_.jacobian +=
        (prediction_.residual - known_.prediction.residual - known_.prediction.jacobian * change) *
        (along / square).transpose();
  known_ = {values, prediction_};
}

}  // namespace lacuna
