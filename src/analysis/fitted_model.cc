#include "analysis/fitted_model.h"

#include <glog/logging.h>

#include <cmath>
#include <limits>
#include <utility>

namespace lacuna {

FittedModel::FittedModel(Eigen::VectorXd residual, Eigen::MatrixXd jacobian,
                         const Eigen::VectorXd& prior_deviation)
    : residual_(std::move(residual)), jacobian_(std::move(jacobian)) {
  CHECK_EQ(residual_.size(), jacobian_.rows());
  CHECK_EQ(prior_deviation.size(), jacobian_.cols());
  Eigen::MatrixXd information = jacobian_.transpose() * jacobian_;
  // Keeps the matrix regular for a parameter without influence and without prior.
  information.diagonal().array() += std::numeric_limits<double>::min();
  for (Eigen::Index k = 0; k < prior_deviation.size(); ++k)
    if (std::isfinite(prior_deviation[k]))
      information(k, k) += 1 / (prior_deviation[k] * prior_deviation[k]);
  information_.compute(information);
}

Eigen::MatrixXd FittedModel::Product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) const {
  Eigen::MatrixXd product = A.transpose() * B;
  if (jacobian_.cols() > 0)
    product -=
        (jacobian_.transpose() * A).transpose() * information_.solve(jacobian_.transpose() * B);
  return product;
}

}  // namespace lacuna
