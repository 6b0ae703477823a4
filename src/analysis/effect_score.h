// How much of what a fitted model leaves unexplained a missing effect would explain, to first
// order, and how well the measurement can tell it from what is fitted already.
//
// With the whitened residual r of the fit, its Jacobian J by the fitted parameters (of prior
// covariance P) and its derivative S by the effect's parameters θ at their null value,
//   r + S θ ~ N(0, s² C),   C = I + J P Jᵀ,   θ ~ N(0, Λ)
// gives, in units of the prior (S ← S Λ^½), with H = Sᵀ C⁻¹ S and b = −Sᵀ C⁻¹ r,
//   ln B = ½ bᵀ (H + s² I)⁻¹ b / s² − ½ ln det(I + H/s²),
// the logarithm of the evidence for the effect over that for none (Kass & Raftery, JASA 90, 1995,
// for a linear model), and θ̂ = (H + s² I)⁻¹ b. It is Rao's score test with a prior: no fit of the
// effect is needed.
#ifndef LACUNA_ANALYSIS_EFFECT_SCORE_H_
#define LACUNA_ANALYSIS_EFFECT_SCORE_H_

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <limits>
#include <vector>

namespace lacuna {

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

struct EffectScore {
  double evidence = 0;        // ln B
  Eigen::VectorXd size;       // θ̂, in the effect's own units
  Eigen::VectorXd deviation;  // of it, the noise scaled to what is left
  double explained = 0;       // share of rᵀ C⁻¹ r that goes
  // Share of what the effect does to the residual that the fitted parameters can do as well: 1, it
  // cannot be seen at all.
  double absorbed = 1;
  // Smallest size of each parameter alone that would stand out by four standard deviations of the
  // noise; infinite where none would.
  Eigen::VectorXd detectable;
};

// `by`: n × m, ∂r/∂θ. `scale`: m, the prior's deviations. `one_sided`: m, the parameter cannot be
// negative; an estimate that is counts as nothing.
EffectScore ScoreEffect(const FittedModel& fitted, const Eigen::MatrixXd& by,
                        const Eigen::VectorXd& scale, const std::vector<bool>& one_sided);

// The largest canonical correlation of two effects' derivatives after what is fitted has been taken
// away, 0 to 1: near 1, this measurement cannot tell them apart by first order; 0 as well where one
// of them is absorbed whole.
double Collinearity(const FittedModel& fitted, const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_EFFECT_SCORE_H_
