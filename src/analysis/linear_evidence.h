// How well models explain a residual that answers linearly to their parameters.
//
// With the residual r (whitened), the derivatives A of the chosen parameters and their priors
// N(m, s²) (of the change δ from where r was taken), the model says
//   r + A δ ~ N(0, v I),   δ ~ N(m, diag s²),
// and the data's density under it, the changes integrated out, is (MacKay, Information Theory,
// Inference, and Learning Algorithms, 2003, ch. 28; here up to a constant that all models share)
//   ln p = −½ min_δ { ‖r + A δ‖²/v + Σ ((δ − m)/s)² } − ½ ln det(I + diag(s) AᵀA diag(s)/v).
// The second term is the price of parameters that could have explained much else.
#ifndef LACUNA_ANALYSIS_LINEAR_EVIDENCE_H_
#define LACUNA_ANALYSIS_LINEAR_EVIDENCE_H_

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace lacuna {

struct LinearPrior {
  double mean = 0;                                             // of the change
  double deviation = std::numeric_limits<double>::infinity();  // > 0; infinite: no prior, no price
  bool positive = false;                                       // the change cannot be negative
};

struct LinearFit {
  double log_evidence = 0;
  Eigen::VectorXd change;     // δ̂, in the order of the chosen columns
  Eigen::VectorXd deviation;  // of it
  double misfit = 0;          // ‖r + A δ̂‖²
};

class LinearModel {
 public:
  // `residual`: n; `columns`: n × k, ∂r/∂δ of everything that may be chosen; `priors`: k.
  LinearModel(const Eigen::VectorXd& residual, const Eigen::MatrixXd& columns,
              std::vector<LinearPrior> priors);

  // The same columns with another residual.
  LinearModel WithResidual(const Eigen::VectorXd& residual, const Eigen::MatrixXd& columns) const;

  // With the chosen columns only. `variance`: v ≥ 0 of what is noise. A change that its prior wants
  // positive and that comes out negative is set to 0; its evidence is that of the prior cut in
  // half, exact for one such parameter and taken parameter by parameter for several.
  LinearFit Fit(const std::vector<int>& chosen, double variance) const;
  LinearFit FitAll(double variance) const;  // with all columns

  // AᵀB of columns a and b after the columns `taken`, with their priors, have taken what they can.
  Eigen::MatrixXd Remaining(const std::vector<int>& taken, const std::vector<int>& a,
                            const std::vector<int>& b, double variance) const;

  // ‖column‖²
  double Square(int column) const { return products_(column, column); }
  const LinearPrior& Prior(int column) const { return priors_[column]; }

  // The largest canonical correlation of two sets of columns after `taken`: near 1, the data cannot
  // tell them apart; 0 as well where one of them is taken whole.
  double Collinearity(const std::vector<int>& taken, const std::vector<int>& a,
                      const std::vector<int>& b, double variance) const;

 private:
  double squares_ = 0;
  Eigen::VectorXd toward_;    // Aᵀ r
  Eigen::MatrixXd products_;  // Aᵀ A
  std::vector<LinearPrior> priors_;
};

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_LINEAR_EVIDENCE_H_
