#include "diagnosis/marginal_nuisances.h"

#include <glog/logging.h>

#include <Eigen/Eigenvalues>
#include <cmath>

namespace lacuna {

MarginalNuisances::MarginalNuisances(const Eigen::MatrixXd& columns,
                                     const std::vector<LinearPrior>& priors)
    : means_(columns.cols()) {
  CHECK_EQ(static_cast<Eigen::Index>(priors.size()), columns.cols());
  Eigen::VectorXd deviations(columns.cols());
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    means_[k] = priors[static_cast<size_t>(k)].mean;
    deviations[k] = priors[static_cast<size_t>(k)].deviation;
  }
  CHECK(deviations.allFinite());
  at_means_ = columns * means_;
  if (columns.cols() == 0) {
    projection_.resize(columns.rows(), 0);
    return;
  }
  const Eigen::MatrixXd products =
      deviations.asDiagonal() * (columns.transpose() * columns) * deviations.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(products);
  const Eigen::ArrayXd values = eigen.eigenvalues().array().max(0);
  const Eigen::ArrayXd share = values.unaryExpr(
      [](double value) { return value > 0 ? -std::expm1(-0.5 * std::log1p(value)) / value : 0.5; });
  const Eigen::MatrixXd scaled = deviations.asDiagonal() * eigen.eigenvectors();
  projection_ = columns * (scaled * share.sqrt().matrix().asDiagonal());
  to_amounts_ = -scaled * ((1 + values) * share.sqrt()).inverse().matrix().asDiagonal();
}

Eigen::VectorXd MarginalNuisances::OfResidual(const Eigen::VectorXd& residual) const {
  return OfDerivatives(residual + at_means_);
}

Eigen::MatrixXd MarginalNuisances::OfDerivatives(const Eigen::MatrixXd& jacobian) const {
  if (projection_.cols() == 0) return jacobian;
  return jacobian - projection_ * (projection_.transpose() * jacobian);
}

Eigen::VectorXd MarginalNuisances::BestAmounts(const Eigen::VectorXd& residual) const {
  if (projection_.cols() == 0) return means_;
  return means_ + to_amounts_ * (projection_.transpose() * (residual + at_means_));
}

}  // namespace lacuna
