// A model, linearised about fitted parameters, beside nuisances: its evidence, and the parameters
// that are best for it.
//
// The evidence is that of the linear Gaussian approximation (analysis/linear_evidence.h) about the
// parameters as they are. All functions but HypothesisAt() and Settle(), which predict, are pure.
#ifndef LACUNA_DIAGNOSIS_FITTED_HYPOTHESIS_H_
#define LACUNA_DIAGNOSIS_FITTED_HYPOTHESIS_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "diagnosis/scored_effect.h"

namespace lacuna {

// A fitted model, linearised about its parameters.
struct FittedHypothesis {
  LinearisedMisfit misfit;          // columns: the problem's parameters, then the adopted nuisances
  std::vector<LinearPrior> priors;  // of the columns
  Eigen::Index parameters = 0;      // number of columns that are the problem's parameters
  // The columns of amounts that must be positive: of parameters on a linear scale whose prior has
  // its mean at or below their lower bound. The prior is truncated at its mean.
  std::vector<int> positive;
  Eigen::VectorXd residual;  // m, with the best amounts of the adopted nuisances
};

// The log evidence of all frames of the fitted recordings, up to a constant that all hypotheses
// share, at the parameters as they are. (The evidence of linear_evidence.h assumes their best
// values to first order, and would reward a fit that has not converged.) Priors of amounts that
// must be positive are truncated, and so is the posterior, whose mode is taken to be where the
// parameters are: as to first order, such an amount that is determined well has ln 2 more than it
// would have if it might be negative, and one at the bound has the same.
struct HypothesisEvidence {
  double log_evidence = 0;
  double misfit = 0;  // ‖whitened residual‖², adopted nuisances at their best amounts
};
// `fitted_only`: the evidence of the frames that were fitted.
HypothesisEvidence EvidenceOf(const FittedHypothesis& hypothesis, const NoiseLevel& noise,
                              bool fitted_only = false);

// The residual of all frames that the misfit of EvidenceOf() is the square of: whitened, in σ, with
// the adopted nuisances at their best amounts.
Eigen::VectorXd WhitenedResidual(const FittedHypothesis& hypothesis, const NoiseLevel& noise);

// The rms of the residual over all observed rows, over σ, with the adopted nuisances at their best
// amounts.
double RmsOverSigma(const FittedHypothesis& hypothesis);

// The model at `values`, with the residuals between the same points as in `correspondences`. Given
// `near`, its Jacobian is used instead of a new one; given `known`, the misfit with Jacobian at
// `values`, nothing is predicted.
FittedHypothesis HypothesisAt(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const AdoptedNuisances& adopted,
                              const LinearisedMisfit& correspondences,
                              const FittedHypothesis* near = nullptr,
                              const LinearisedMisfit* known = nullptr);

// A hypothesis, and the values of the problem's parameters there.
struct Settled {
  Eigen::VectorXd values;
  FittedHypothesis hypothesis;
};

// The log evidence of all frames that the best change of the parameters within their bounds would
// gain, to first order.
double FirstOrderGain(const CalibrationProblem& problem, const Settled& at,
                      const NoiseLevel& noise);

// The hypothesis at the best parameters for all frames or for those that were fitted, by
// Gauss–Newton steps from `start`. The steps are small, so the Jacobian is kept.
Settled Settle(const CalibrationProblem& problem, Settled start, const AdoptedNuisances& adopted,
               const LinearisedMisfit& correspondences, const NoiseLevel& noise, bool fitted_only);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_FITTED_HYPOTHESIS_H_
