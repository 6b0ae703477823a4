#include "fit/prior_cost.h"

#include <cmath>

namespace lacuna {

double FromPriorMean(const CalibratedParameter& parameter, double value) {
  if (!std::isfinite(parameter.prior_deviation)) return 0;
  return (ToFree(parameter, value) - ToFree(parameter, PriorMeanOf(parameter))) /
         parameter.prior_deviation;
}

double CostAt(const std::vector<CalibratedParameter>& parameters, const Eigen::VectorXd& values,
              const Eigen::VectorXd& residual) {
  double cost = residual.squaredNorm();
  for (size_t k = 0; k < parameters.size(); ++k)
    cost += std::pow(FromPriorMean(parameters[k], values[static_cast<Eigen::Index>(k)]), 2);
  return 0.5 * cost;
}

void DeriveByFreeValues(const std::vector<CalibratedParameter>& parameters,
                        const Eigen::VectorXd& values, Eigen::MatrixXd* columns) {
  for (size_t k = 0; k < parameters.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    if (parameters[k].log_scale) columns->col(at) *= values[at];
  }
}

QuadraticCost CostAbout(const std::vector<CalibratedParameter>& parameters,
                        const Eigen::VectorXd& values, const Eigen::VectorXd& residual,
                        const Eigen::MatrixXd& columns) {
  QuadraticCost model{CostAt(parameters, values, residual), columns.transpose() * residual,
                      columns.transpose() * columns};
  for (size_t k = 0; k < parameters.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    const double deviation = parameters[k].prior_deviation;
    if (!std::isfinite(deviation)) continue;
    model.gradient[at] += FromPriorMean(parameters[k], values[at]) / deviation;
    model.information(at, at) += 1 / (deviation * deviation);
  }
  return model;
}

}  // namespace lacuna
