// The model as a calibration sees it: a function from parameters to whitened residuals.
//
// The residual r holds predicted minus measured values, divided by the standard deviation of their
// noise and decorrelated where the noise is correlated, so that each entry has unit variance if the
// model is right.
#ifndef LACUNA_FIT_RESIDUAL_FUNCTION_H_
#define LACUNA_FIT_RESIDUAL_FUNCTION_H_

#include <Eigen/Core>
#include <functional>
#include <string>
#include <vector>

namespace lacuna {

// The residual at some parameters and, if it was requested, its Jacobian.
struct ResidualEvaluation {
  bool usable = false;       // whether the model could be predicted
  std::string message;       // why it could not
  Eigen::VectorXd residual;  // n, whitened, dimensionless
  Eigen::MatrixXd jacobian;  // n × parameters, ∂r/∂θ; 0 × 0 if it was not requested
  // For each row, the row of the same quantity one frame earlier, or −1 in its first frame. Empty
  // if the rows are not ordered in time.
  std::vector<Eigen::Index> before = {};
  // The number of rows that stand for something that was not seen or not read. They are 0, so that
  // the layout of the rows does not depend on the parameters, and are no measurements.
  Eigen::Index unobserved = 0;

  // The number of measurements.
  Eigen::Index Observed() const { return residual.size() - unobserved; }
};

// Must be a function of the parameters θ (SI) alone, and must return the same number of rows for
// all of them. The Jacobian may be omitted when `with_jacobian` is false.
using ResidualFunction =
    std::function<ResidualEvaluation(const Eigen::VectorXd& parameters, bool with_jacobian)>;

}  // namespace lacuna

#endif  // LACUNA_FIT_RESIDUAL_FUNCTION_H_
