// A residual after everything that its fit could do about it has been taken away.
#ifndef LACUNA_ANALYSIS_FITTED_MODEL_H_
#define LACUNA_ANALYSIS_FITTED_MODEL_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>

namespace lacuna {

// With the Jacobian J of the fitted parameters and their priors' variances P the residual's
// covariance is C = I + J P Jᵀ, in units of the noise.
// What a fit has explained, and what it left.
class FittedModel {
 public:
  // `residual`: n, whitened, predicted minus measured. `jacobian`: n × k. `prior_deviation`: k,
  // infinite where there is no prior.
  FittedModel(Eigen::VectorXd residual, Eigen::MatrixXd jacobian,
              const Eigen::VectorXd& prior_deviation);

  const Eigen::VectorXd& residual() const { return residual_; }
  // Aᵀ C⁻¹ B; A and B of n rows.
  Eigen::MatrixXd Product(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) const;

 private:
  Eigen::VectorXd residual_;
  Eigen::MatrixXd jacobian_;
  Eigen::LDLT<Eigen::MatrixXd> information_;  // JᵀJ + P⁻¹
};

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_FITTED_MODEL_H_
