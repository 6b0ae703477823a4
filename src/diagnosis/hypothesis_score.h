// Hypotheses about one misfit, each a few columns of what it can change there, scored by how well
// they explain it to first order, and what they would explain by chance.
#ifndef LACUNA_DIAGNOSIS_HYPOTHESIS_SCORE_H_
#define LACUNA_DIAGNOSIS_HYPOTHESIS_SCORE_H_

#include <Eigen/Core>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/linear_misfit.h"

namespace lacuna {

// Standard deviations by which an effect must stand out to be noticed among some dozens in four
// cases of five: what "detectable" means.
inline constexpr double kStandsOut = 5;

// What first order says about one hypothesis.
struct Score {
  double evidence = 0;        // ln of the odds against the model as it is, less the price of trying
  Eigen::VectorXd size;       // of the candidate's amounts, in their units
  Eigen::VectorXd deviation;  // of it
  Eigen::VectorXd detectable;  // the smallest sizes that would have been noticed; may be infinite
  double explained = 0;        // share of the squared misfit, of all frames, that goes
  // Share of what the effect does to the misfit that the fitted parameters can do as well: 1, it
  // cannot be seen at all.
  double absorbed = 1;
  double held_out_in_noise = 0;  // expected error of the held-out frames, in σ; of all without any
};

// A misfit and the columns of all hypotheses about it, whitened; seen by all frames and by the
// fitted ones.
struct WeighedColumns {
  LinearGaussianModel all, fitted;
  Eigen::VectorXd residual;  // of all frames
  Eigen::MatrixXd columns;
};
WeighedColumns WeighColumns(const LinearisedMisfit& misfit, const Eigen::MatrixXd& columns,
                            const std::vector<LinearPrior>& priors, double correlation_time);

std::vector<int> Joined(std::vector<int> a, const std::vector<int>& b);

// Of the columns `own` beside those of the model, `base`; `before`: the model's own fit.
Score ScoreOf(const WeighedColumns& weighed, const std::vector<int>& base, const LinearFit& before,
              const std::vector<int>& own, double variance, const LinearisedMisfit& misfit);

// The largest evidence that all effects find in nineteen of twenty residuals that no effect has
// made: what `best` leaves, its frames moved along and its signs drawn anew.
double ControlEvidence(const WeighedColumns& weighed, const LinearisedMisfit& misfit,
                       const std::vector<int>& best, const std::vector<int>& base,
                       const std::vector<std::vector<int>>& effects, double variance);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_HYPOTHESIS_SCORE_H_
