// Nuisances of a fit, integrated out.
//
// Nuisances change the whitened residual r of a model to r + N a, with constant columns N and
// amounts a ~ N(m, diag s²). Their amounts need no search: with the best ones for each r,
//   min_a ‖r + N a‖² + ‖(a − m)/s‖² = ‖W (r + N m)‖²,   W = (I + N diag(s²) Nᵀ)^(−½),
// so that a fit of W (r + N m) alone finds the same values of the other parameters, with the same
// covariance (variable projection: Golub & Pereyra, SIAM J. Numer. Anal. 10, 1973). With the
// eigenvectors V and eigenvalues λ of diag(s) NᵀN diag(s),
//   W = I − P Pᵀ,   P = N diag(s) V diag(√f),   f = (1 − 1/√(1 + λ))/λ.
// Nuisances of single frames have hundreds of columns; a search over their amounts takes longer
// than the predictions of a small model.
#ifndef LACUNA_DIAGNOSIS_MARGINAL_NUISANCES_H_
#define LACUNA_DIAGNOSIS_MARGINAL_NUISANCES_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/linear_evidence.h"

namespace lacuna {

class MarginalNuisances {
 public:
  // `columns` (rows × amounts): N. One prior for each, with a finite deviation; that an amount must
  // be positive is not regarded.
  MarginalNuisances(const Eigen::MatrixXd& columns, const std::vector<LinearPrior>& priors);

  // W (r + N m).
  Eigen::VectorXd OfResidual(const Eigen::VectorXd& residual) const;
  // W J.
  Eigen::MatrixXd OfDerivatives(const Eigen::MatrixXd& jacobian) const;
  // The amounts with the smallest sum of squares at this r.
  Eigen::VectorXd BestAmounts(const Eigen::VectorXd& residual) const;

  const Eigen::MatrixXd& projection() const { return projection_; }  // P
  const Eigen::VectorXd& at_means() const { return at_means_; }      // N m

 private:
  Eigen::MatrixXd projection_;
  Eigen::VectorXd at_means_;
  Eigen::VectorXd means_;
  Eigen::MatrixXd to_amounts_;  // a − m = to_amounts · Pᵀ(r + N m)
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_MARGINAL_NUISANCES_H_
