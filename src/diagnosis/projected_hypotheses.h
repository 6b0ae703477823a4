// The evidence of hypotheses beside columns that are already in the model, for one residual after
// another.
//
// Let B be the columns that are taken, with the prior covariance P, and v the variance of the
// noise. Marginalising over the amounts of B turns the products of the other columns and the
// residual into
//   t' = t − G_B M⁻¹ t_B,   S = G − G_B M⁻¹ G_Bᵀ,   M = BᵀB + v P⁻¹,
// with t = Aᵀr and G = AᵀA. The logarithm of the Bayes factor of a hypothesis with columns h and
// the prior covariance Q is then
//   ½ t'_hᵀ (S_hh + v Q⁻¹)⁻¹ t'_h / v − ½ ln det(I + Q S_hh / v).
// A prior that requires a positive amount is truncated at 0, which adds the logarithm of 2 to the
// power of the number of such amounts, times the posterior probability that all of them are
// positive (analysis/positive_normal.h: exact for one and two). An unknown smooth force has the
// prior covariance s² I with unknown s: its Bayes factor is the mean over kForceScales. With the
// eigenvalues λ of S_hh and c, the components of t'_h along its eigenvectors, the logarithm for one
// s is
//   ½ Σ c²/(λ + v/s²)/v − ½ Σ ln(1 + s² λ/v).
//
// If the taken columns are all that is missing, with amounts from their priors, the residual has
// the covariance C = v I + B P Bᵀ, and by Woodbury's identity
//   t' = v Aᵀ C⁻¹ r,   S = v Aᵀ C⁻¹ A,   min_b { ‖r + B b‖² + v bᵀP⁻¹b } = v rᵀ C⁻¹ r.
// These are therefore the products of white noise with the variance v, in as many rows as the
// residual has less the number of taken columns without a prior (Marginal()).
//
// The matrices depend on the columns alone, so that thousands of simulated residuals cost little.
#ifndef LACUNA_DIAGNOSIS_PROJECTED_HYPOTHESES_H_
#define LACUNA_DIAGNOSIS_PROJECTED_HYPOTHESES_H_

#include <Eigen/Core>
#include <vector>

#include "diagnosis/hypothesis_space.h"

namespace lacuna {

// Standard deviations of an unknown smooth force, m/s², each as probable as the others: from less
// than any recording could show to about gravity. The smallest ones are needed: every visible
// history of the force costs evidence, more so the larger the force that the prior expects, so that
// without them the evidence for a small force would stay far below 0.
inline constexpr double kForceScales[] = {0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1, 3, 10};

// The products of one residual: rᵀr and t.
struct ResidualProducts {
  double squares = 0;
  Eigen::VectorXd toward;
};

class ProjectedHypotheses {
 public:
  // `further`: columns beside the base that are taken, too. The space must outlive this.
  explicit ProjectedHypotheses(const HypothesisSpace& space, const std::vector<int>& further = {});

  // t'
  Eigen::VectorXd Project(const Eigen::VectorXd& toward) const;
  // The misfit and t'.
  ResidualProducts ProjectAll(const ResidualProducts& residual) const;
  // The misfit: min over the taken columns of ‖r + B b‖² + v bᵀP⁻¹b.
  double Misfit(const ResidualProducts& residual) const;
  // The misfit with the noise with which the rows were whitened, i.e. with v = 1.
  double MisfitOfGivenNoise(const ResidualProducts& residual) const;
  // The number of rows less that of the taken columns without a prior, at least 1: the expected
  // misfit in units of v.
  Eigen::Index Freedom() const;
  // The space after the taken columns have been integrated out: with the misfit, t' and S as its
  // products, Freedom() rows and an empty base. The products of the taken columns are 0; all
  // columns and hypotheses keep their places.
  HypothesisSpace Marginal() const;
  // The logarithm of the Bayes factor of each hypothesis of the space against the taken columns
  // alone, from t'. 0 for a hypothesis whose columns are taken.
  Eigen::VectorXd LogBayesFactors(const Eigen::VectorXd& projected) const;
  // LogBayesFactors() of the residual of the space itself.
  Eigen::VectorXd FactorsOfResidual() const {
    return LogBayesFactors(Project(space_.model.toward()));
  }
  // The amounts with the largest posterior density of a hypothesis that is not an unknown force, 0
  // or more where they must be positive, and their covariance matrix without that restriction.
  struct Amounts {
    Eigen::VectorXd value;
    Eigen::MatrixXd covariance;
  };
  Amounts AmountsOf(size_t hypothesis, const Eigen::VectorXd& projected) const;
  // S
  const Eigen::MatrixXd& products() const { return products_; }
  const HypothesisSpace& space() const { return space_; }

 private:
  struct Own {
    bool taken = false;
    std::vector<Eigen::Index> positive;  // amounts that must be positive
    Eigen::MatrixXd gain;  // ½ (S_hh + v Q⁻¹)⁻¹ / v; empty where the hypothesis is not weighed
    Eigen::MatrixXd covariance;  // of the amounts: v (S_hh + v Q⁻¹)⁻¹
    double occam = 0;            // ½ ln det(I + Q S_hh / v)
  };
  // The eigenvectors and eigenvalues of S_hh of an unknown force, without those that are rounding;
  // empty where there is none.
  struct Force {
    Eigen::MatrixXd vectors;
    Eigen::VectorXd values;
  };
  Own Prepare(const WeighedHypothesis& hypothesis) const;
  double LogBayesFactorOfForce(const Eigen::VectorXd& toward) const;

  const HypothesisSpace& space_;
  std::vector<int> taken_;
  Eigen::MatrixXd weights_;   // M⁻¹ G_Bᵀ, taken × columns
  Eigen::MatrixXd inverse_;   // M⁻¹
  Eigen::MatrixXd products_;  // S
  std::vector<Own> own_;
  Force force_;
};

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_PROJECTED_HYPOTHESES_H_
