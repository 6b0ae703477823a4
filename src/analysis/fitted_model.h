// The residual of a fitted model and its covariance when the fit is taken into account.
//
// The residual r is whitened, so that the noise has unit covariance. With the Jacobian J = ∂r/∂θ of
// the fitted parameters and the variances P of their priors, the covariance of r over noise and
// parameters is
//   C = I + J P Jᵀ,    C⁻¹ = I − J (JᵀJ + P⁻¹)⁻¹ Jᵀ.
// C⁻¹ discounts directions of the residual that a refit of the parameters could remove; for
// parameters without prior it removes them completely.
#ifndef LACUNA_ANALYSIS_FITTED_MODEL_H_
#define LACUNA_ANALYSIS_FITTED_MODEL_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace lacuna {

class FittedModel {
 public:
  // `residual` (n) is predicted minus measured, `jacobian` is n × k, and `prior_deviation` (k)
  // holds √P, infinite for parameters without prior. CHECKs the sizes.
  FittedModel(Eigen::VectorXd residual, Eigen::MatrixXd jacobian,
              const Eigen::VectorXd& prior_deviation);

  const Eigen::VectorXd& residual() const { return residual_; }
  // Aᵀ C⁻¹ B for matrices A and B with n rows.
  Eigen::MatrixXd Product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) const;

 private:
  Eigen::VectorXd residual_;
  Eigen::MatrixXd jacobian_;
  Eigen::LDLT<Eigen::MatrixXd> information_;  // JᵀJ + P⁻¹
};

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_FITTED_MODEL_H_
