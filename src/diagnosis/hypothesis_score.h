// Scores hypotheses about one misfit to first order.
//
// A hypothesis is a set of columns C that changes the whitened residual r to r + C a. Its evidence
// is the difference of the log evidence of the linear Gaussian models with and without C
// (analysis/linear_evidence.h), each at the best values of its parameters. Sets of columns are
// given as indices into WeighedColumns::columns. All functions are pure.
#ifndef LACUNA_DIAGNOSIS_HYPOTHESIS_SCORE_H_
#define LACUNA_DIAGNOSIS_HYPOTHESIS_SCORE_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/linear_misfit.h"

namespace lacuna {

struct Score {
  double evidence = 0;        // log Bayes factor against the model, less the selection penalty
  Eigen::VectorXd size;       // of the candidate's amounts, in their units
  Eigen::VectorXd deviation;  // standard deviations of the size
  // The smallest sizes that would have been noticed (RankingThresholds::detectable_deviations);
  // infinite where the residual does not depend on the size.
  Eigen::VectorXd detectable;
  double explained = 0;  // share of the squared residual, of all frames, that the effect explains
  // Share of the effect's change that the fitted parameters can compensate for; 1: it is invisible.
  double absorbed = 1;
  // Expected rms of the held-out frames (of all frames if none are held out), over σ, after a fit
  // with the effect.
  double held_out_rms_over_sigma = 0;
};

// The residual and the columns of all hypotheses, whitened with the noise: once for all frames, and
// once for the frames that were fitted.
struct WeighedColumns {
  LinearGaussianModel all, fitted;
  Eigen::VectorXd residual;  // of all frames
  Eigen::MatrixXd columns;   // of all frames
};

// `columns` and `priors` have the same order; `correlation_time` is that of the noise, s.
WeighedColumns WeighColumns(const LinearisedMisfit& misfit, const Eigen::MatrixXd& columns,
                            const std::vector<LinearPrior>& priors, double correlation_time);

// `count` indices from `first`.
std::vector<int> IndexRange(Eigen::Index first, Eigen::Index count);

// The indices of a, then those of b.
std::vector<int> Joined(std::vector<int> a, const std::vector<int>& b);

// The score of the columns `own` beside the columns `base` of the model, whose own fit is `before`.
// `variance`: of the whitened noise. The evidence contains no selection penalty yet.
Score ScoreOf(const WeighedColumns& weighed, const std::vector<int>& base, const LinearFit& before,
              const std::vector<int>& own, double variance, const LinearisedMisfit& misfit);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_HYPOTHESIS_SCORE_H_
