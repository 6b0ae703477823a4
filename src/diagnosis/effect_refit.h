// Fits a model with one more effect, which tests what first order has predicted for it.
//
// The evidence of a refitted model is that of its linear Gaussian approximation about the refitted
// parameters (analysis/linear_evidence.h). Noise is white during a fit and correlated, as
// estimated, in the final comparison.
#ifndef LACUNA_DIAGNOSIS_EFFECT_REFIT_H_
#define LACUNA_DIAGNOSIS_EFFECT_REFIT_H_

#include <Eigen/Core>
#include <limits>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/extended_problem.h"
#include "diagnosis/fitted_hypothesis.h"
#include "record/model_errors.h"

namespace lacuna {

// The errors of a model with these parameter values, over all recordings. `known`, if given: its
// misfit there, which is then not predicted again.
ModelErrors ErrorsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                     const LinearisedMisfit* known = nullptr);

struct EffectRefit {
  std::string message;  // why the refit is not usable; empty: it is usable
  // Why the fit ended before it had converged; empty: it has converged. What it has found is less
  // than the effect can explain, so that it refutes nothing (Predicts).
  std::string unconverged;
  Calibration calibration;
  Eigen::VectorXd amounts;               // of the adopted nuisances, at the end of the fit
  Eigen::VectorXd effect;                // all parameters of the effect, in the order of its card
  Eigen::VectorXd model;                 // the fitted parameters that the model had before
  std::vector<ParameterEstimate> sizes;  // those that make its size; empty for a pilot
  std::vector<NamedEstimate> others;     // its other fitted parameters: place, time
  ModelErrors errors;
  FittedHypothesis at_fit;        // at the best parameters for the fitted frames
  Eigen::VectorXd values_at_fit;  // these parameters
  FittedHypothesis hypothesis;    // at the best parameters for all frames
};

// The log evidence of all frames, and that of the held-out frames given the fitted ones:
// ln p(held-out | fitted) = ln p(all) − ln p(fitted). It measures how well a model predicts by the
// width that it claims for its predictions.
struct RefitEvidence {
  double all = 0, held_out = 0;
  double misfit = 0;  // as in HypothesisEvidence, of all frames
};
RefitEvidence EvidenceOf(const EffectRefit& refit, const NoiseLevel& noise);

// The space of all other hypotheses beside refitted effects, with the columns that the ranking
// found. `types`: the refitted effects.
HypothesisSpace SpaceOf(const FittedHypothesis& hypothesis, const EffectRanking& ranking,
                        const std::vector<std::string>& types, const NoiseLevel& noise);

// Whether a refit gained less than RefitThresholds::kept_share of the `predicted` first-order
// evidence although more could be explained. `noise` is the squared residual expected of noise; a
// refit that explains most of what exceeds it has found its minimum, and first order predicted too
// much. As the noise is estimated, this exception needs a clear excess.
bool FallsShort(const HypothesisEvidence& without, const HypothesisEvidence& refit, double noise,
                double predicted);

// How much better the refitted model predicts what was not fitted than the one without the effect:
// the difference of ln p(not fitted | fitted). Held-out frames count by the width that each model
// claims for its prediction (RefitEvidence), recordings that were not fitted by their squared
// residuals and the persistence of the noise.
double PredictiveGain(const EffectRefit& with, const EffectRefit& without, const NoiseLevel& noise);

// Whether that is compatible with the effect being missing. If it is, the gain is below −ln 100 in
// fewer than one recording in 100, whatever the size of the effect: exp(−gain) then is a ratio of
// densities with the mean 1 (Markov's inequality). True where nothing is held out, and if the refit
// has not converged: other parameters may predict better. `tests`: the number of comparisons all of
// which the refit must pass; each allows for so much less, so that the bound holds for all of them
// together (Bonferroni).
bool Predicts(const EffectRefit& with, const EffectRefit& without, const NoiseLevel& noise,
              int tests = 1);

// Whether the held-out error with the effect is clearly larger than without it, which shows that
// the effect follows the fitted frames with wrong parameters.
bool PredictsWorse(const ModelErrors& with, const ModelErrors& without);

// Where a refit starts: where ExtendedProblem::Start() does, or with the effect held near its
// predicted size and the others fitted to that.
enum class RefitFrom { kFirstOrder, kFixedSize };

// Fits the baseline with the effect and the adopted nuisances. Null `effect`: with the nuisances
// alone, so that the baseline is compared at its best too. `is_far_off` says that the baseline is
// far from the measurements: a refit that has not converged is then repeated from the result of an
// independent fit of the model with the effect. `without`: the refit with the same nuisances and
// without the effect, beside whose parameters the refit may start; null: unknown. `hopeless_cost`:
// as in CalibrationOptions. A failed fit gives a message. Refits of one baseline may run in several
// threads. Throws Interrupted.
EffectRefit Refit(const BaselineModel& baseline, const ScoredVariant* effect,
                  const AdoptedNuisances& adopted, bool is_far_off,
                  RefitFrom from = RefitFrom::kFirstOrder, const EffectRefit* without = nullptr,
                  double hopeless_cost = std::numeric_limits<double>::infinity());

// The same fit from these values of the problem's parameters, at which another fit of the same
// model has ended: one that had not converged, or one beside other nuisances or with a further
// effect. Values beyond the bounds of the parameters are moved to them.
EffectRefit RefitFromValues(const BaselineModel& baseline, const ScoredVariant* effect,
                            const AdoptedNuisances& adopted, const Eigen::VectorXd& values,
                            double hopeless_cost = std::numeric_limits<double>::infinity());

// Continues a fit that has not converged from where it has ended, as long as it gains and its cost
// does not exceed `hopeless_cost`, within the budget of one effect (RefitThresholds::
// most_of_effect). `predictions`: those that were made for this effect before this fit. A fit that
// cannot be continued stays as it is. Throws Interrupted.
EffectRefit ContinueWithinBudget(const BaselineModel& baseline, const ScoredVariant* effect,
                                 const AdoptedNuisances& adopted, EffectRefit refit,
                                 double hopeless_cost = std::numeric_limits<double>::infinity(),
                                 int predictions = 0);

// The refit beside other nuisances, without a new fit: it is settled from where it is with the
// Jacobian that it has, which takes a few predictions without derivatives. Its estimates stay those
// of its fit. A model that cannot be predicted there gives a message.
EffectRefit SettledBeside(const BaselineModel& baseline, const ScoredVariant& effect,
                          const AdoptedNuisances& adopted, EffectRefit refit);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EFFECT_REFIT_H_
