// Evidence of competing models for a residual that depends linearly on their parameters.
//
// Let r be the whitened residual, A its derivatives with respect to the chosen parameters and
// N(m, s²) the priors of the changes δ of these parameters. The model states
//   r + A δ ~ N(0, v I),   δ ~ N(m, diag s²),
// and its evidence, the density of the data with the changes integrated out, is (MacKay,
// Information Theory, Inference, and Learning Algorithms, 2003, ch. 28; up to a constant common to
// all models)
//   ln p = −½ min_δ { ‖r + A δ‖²/v + Σ ((δ − m)/s)² } − ½ ln det(I + diag(s) AᵀA diag(s)/v).
// The second term penalises parameters that could have explained many other residuals as well.
#ifndef LACUNA_ANALYSIS_LINEAR_EVIDENCE_H_
#define LACUNA_ANALYSIS_LINEAR_EVIDENCE_H_

#include <Eigen/Core>
#include <limits>
#include <vector>

namespace lacuna {

struct LinearPrior {
  double mean = 0;                                             // m, of the change δ
  double deviation = std::numeric_limits<double>::infinity();  // s > 0; infinite: no prior
  bool positive = false;                                       // restricts the change to δ ≥ 0
};

// The logarithm of the mean of exp(value): from the log Bayes factors of alternatives that are
// equally probable, that of all of them together. There must be a value.
double LogMeanExp(const std::vector<double>& values);

// Appends columns (n × k) with their k priors to `columns` and `priors`. An empty matrix gets the
// rows of `more`. CHECKs the sizes.
void AppendColumns(const Eigen::MatrixXd& more, const std::vector<LinearPrior>& more_priors,
                   Eigen::MatrixXd* columns, std::vector<LinearPrior>* priors);

struct LinearFit {
  double log_evidence = 0;    // ln p, natural logarithm
  Eigen::VectorXd change;     // δ̂, in the order of the chosen columns
  Eigen::VectorXd deviation;  // posterior standard deviations of the changes
  double misfit = 0;          // ‖r + A δ̂‖²
};

class LinearGaussianModel {
 public:
  // `residual` has n entries, `columns` (n × k) holds ∂r/∂δ for all parameters that may be chosen,
  // and `priors` has k entries. CHECKs the sizes and that the deviations are positive.
  LinearGaussianModel(const Eigen::VectorXd& residual, const Eigen::MatrixXd& columns,
                      std::vector<LinearPrior> priors);

  // A model of known products: rᵀr, Aᵀr and AᵀA, for k columns with k priors. CHECKs the sizes.
  static LinearGaussianModel FromProducts(double squares, Eigen::VectorXd toward,
                                          Eigen::MatrixXd products,
                                          std::vector<LinearPrior> priors);

  // A model with another residual and the values of `columns` for it; the products AᵀA are kept.
  LinearGaussianModel WithResidual(const Eigen::VectorXd& residual,
                                   const Eigen::MatrixXd& columns) const;

  // Fits the chosen columns with noise of the given variance v > 0. The changes are those of least
  // cost, in the equation above, among the ones that are not negative where their prior requires
  // them to be positive. The evidence then belongs to the priors truncated at 0; it is exact for
  // one such parameter and approximate, treating the parameters independently, for several. The
  // deviations are those without the truncation.
  LinearFit Fit(const std::vector<int>& chosen, double variance) const;
  LinearFit FitAll(double variance) const;  // fits all columns

  // The products AᵀB of columns a and b after the columns `taken`, with their priors, have been
  // projected out.
  Eigen::MatrixXd Remaining(const std::vector<int>& taken, const std::vector<int>& a,
                            const std::vector<int>& b, double variance) const;

  // ‖column‖²
  double Square(int column) const { return products_(column, column); }
  const LinearPrior& Prior(int column) const { return priors_[column]; }
  const std::vector<LinearPrior>& priors() const { return priors_; }
  double squares() const { return squares_; }                    // rᵀr
  const Eigen::VectorXd& toward() const { return toward_; }      // Aᵀr
  const Eigen::MatrixXd& products() const { return products_; }  // AᵀA

  // The largest canonical correlation, 0 to 1, of two sets of columns after `taken` has been
  // projected out. Near 1 the data cannot distinguish the two sets. It is 0 if nothing remains of
  // one of them.
  double Collinearity(const std::vector<int>& taken, const std::vector<int>& a,
                      const std::vector<int>& b, double variance) const;

 private:
  LinearGaussianModel() = default;

  double squares_ = 0;        // rᵀ r
  Eigen::VectorXd toward_;    // Aᵀ r
  Eigen::MatrixXd products_;  // Aᵀ A
  std::vector<LinearPrior> priors_;
};

}  // namespace lacuna

#endif  // LACUNA_ANALYSIS_LINEAR_EVIDENCE_H_
