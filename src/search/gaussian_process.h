// Gaussian process regression for small numbers of points and variables.
//
//   y = f(x) + ε,   f ~ GP(0, s² k),   ε ~ N(0, s² η)
//   k(x, x') = (1 + r + r²/3) exp(-r),   r² = 5 Σ_i ((x_i - x'_i) / l_i)²      (Matérn 5/2)
//
// C. E. Rasmussen and C. K. I. Williams, "Gaussian Processes for Machine Learning", 2006, eq. 2.25,
// 2.26, 4.17 and 5.8. Points are expected in the unit cube and values with mean 0 and variance 1.
#ifndef LACUNA_SEARCH_GAUSSIAN_PROCESS_H_
#define LACUNA_SEARCH_GAUSSIAN_PROCESS_H_

#include <Eigen/Core>

namespace lacuna {

struct GaussianProcessScales {
  Eigen::VectorXd log_lengths;  // n, ln l_i
  double log_noise = -6;        // ln η
};

class GaussianProcess {
 public:
  struct Prediction {
    double mean = 0;
    double deviation = 0;  // standard deviation of f, without the noise
  };

  // Conditions the process on N observations. `points`: n × N; `values`: N.
  GaussianProcess(const Eigen::MatrixXd& points, const Eigen::VectorXd& values,
                  const GaussianProcessScales& scales);

  // The posterior mean and standard deviation at `x` (n).
  Prediction At(const Eigen::VectorXd& x) const;

  // ln p(values | scales), maximised over s², up to an additive constant. -∞ if the covariance
  // matrix is not positive definite in double precision; At() must then not be called.
  double LogLikelihood() const { return log_likelihood_; }

 private:
  Eigen::VectorXd Covariances(const Eigen::VectorXd& x) const;

  Eigen::MatrixXd points_;  // n × N, divided by the lengths
  Eigen::VectorXd inverse_lengths_;
  Eigen::MatrixXd factor_;  // lower Cholesky factor of k + η, stored transposed
  Eigen::VectorXd weights_;
  double variance_ = 0;  // s²
  double log_likelihood_ = 0;
};

// Returns the scales that maximise the likelihood times a weak prior, ln l_i ~ N(ln ½, 1), within
// 0.05 <= l_i <= 10 and 1e-8 <= η <= 1. The search starts at `first` and evaluates the likelihood
// at most `evaluations` times. `points`: n × N; `values`: N.
GaussianProcessScales FitScales(const Eigen::MatrixXd& points, const Eigen::VectorXd& values,
                                const GaussianProcessScales& first, int evaluations);

}  // namespace lacuna

#endif  // LACUNA_SEARCH_GAUSSIAN_PROCESS_H_
