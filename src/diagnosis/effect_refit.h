// Fits a model with one more effect, which tests what first order has predicted for it.
//
// The evidence of a refitted model is that of its linear Gaussian approximation about the refitted
// parameters (analysis/linear_evidence.h). Noise is white during a fit and correlated, as
// estimated, in the final comparison.
#ifndef LACUNA_DIAGNOSIS_EFFECT_REFIT_H_
#define LACUNA_DIAGNOSIS_EFFECT_REFIT_H_

#include <Eigen/Core>
#include <algorithm>
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
  // Why the fit ended before it had converged, or was not settled; empty: it has converged. What it
  // has found is less than the effect can explain, so that it refutes nothing (Predicts).
  std::string unconverged;
  Calibration calibration;
  Eigen::VectorXd nuisance_amounts;  // of the adopted nuisances, at the end of the fit
  Eigen::VectorXd effect_values;     // of all parameters of the effect, in the order of its card
  Eigen::VectorXd baseline_values;   // of the fitted parameters that the model had before
  std::vector<ParameterEstimate> sizes;  // those that make its size; empty for a pilot
  // Of the sizes: the fit has ended at the limit of what is plausible.
  std::vector<bool> at_limit;
  std::vector<NamedEstimate> others;  // its other fitted parameters: place, time
  ModelErrors errors;
  FittedHypothesis at_fit;        // at the best parameters for the fitted frames
  Eigen::VectorXd values_at_fit;  // these parameters
  FittedHypothesis hypothesis;    // at the best parameters for all frames

  bool IsAtLimit() const {
    return std::find(at_limit.begin(), at_limit.end(), true) != at_limit.end();
  }
};

// The log evidence of all frames, and that of the held-out frames given the fitted ones:
// ln p(held-out | fitted) = ln p(all) − ln p(fitted). It measures how well a model predicts by the
// width that it claims for its predictions.
struct RefitEvidence {
  double all = 0, held_out = 0;
  double misfit = 0;  // as in HypothesisEvidence, of all frames
};
RefitEvidence EvidenceOf(const EffectRefit& refit, const NoiseLevel& noise);

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

// Whether that is incompatible with the effect being missing. If it is missing, the gain is below
// −ln 100 in fewer than one recording in 100, whatever the size of the effect: exp(−gain) then is a
// ratio of densities with the mean 1 (Markov's inequality). False where nothing is held out.
// `tests`: the number of comparisons all of which the refit must pass; each allows for so much
// less, so that the bound holds for all of them together (Bonferroni).
bool IsContradicted(const EffectRefit& with, const EffectRefit& without, const NoiseLevel& noise,
                    int tests = 1);

// Whether the held-out frames do not refute the effect: they do not contradict the refit, or other
// parameters may predict better, because the refit has not converged, or because its size has ended
// at the limit of what is plausible.
bool Predicts(const EffectRefit& with, const EffectRefit& without, const NoiseLevel& noise,
              int tests = 1);

// Whether the held-out error with the effect is clearly larger than without it, which shows that
// the effect follows the fitted frames with wrong parameters.
bool PredictsWorse(const ModelErrors& with, const ModelErrors& without);

// What effects are added to: the baseline, and the nuisances beside it. References must outlive it.
struct RefitSetting {
  const BaselineModel& model;
  const AdoptedNuisances& adopted;
};

// Where a refit starts: where ExtendedProblem::Start() does, or with the effect held near its
// predicted size and the others fitted to that.
enum class RefitFrom { kFirstOrder, kFixedSize };

struct RefitOptions {
  // The baseline is far from the measurements. A refit that does not come down to the noise
  // (RefitThresholds::rms_at_noise) is then repeated from the result of an independent fit of the
  // model with the effect.
  bool is_far_off = false;
  RefitFrom from = RefitFrom::kFirstOrder;
  // The refit with the same nuisances and without the effect, beside whose parameters the refit may
  // start; null: unknown.
  const EffectRefit* without = nullptr;
  // CalibrationOptions::hopeless_cost of the fit; one that ends above it is not settled, and counts
  // as not converged.
  double hopeless_cost = std::numeric_limits<double>::infinity();
};

// Fits the baseline with the effect and the adopted nuisances. Null `effect`: with the nuisances
// alone, so that the baseline is compared at its best too. A failed fit gives a message. Refits of
// one baseline may run in several threads. Throws Interrupted.
EffectRefit Refit(const RefitSetting& setting, const ScoredVariant* effect,
                  const RefitOptions& options = {});

// Refit() from these values of the problem's parameters, at which another fit of the same model has
// ended: one that had not converged, or one beside other nuisances or with a further effect. Values
// beyond the bounds of the parameters are moved to them. `hopeless_cost`: as in RefitOptions.
EffectRefit RefitFromValues(const RefitSetting& setting, const ScoredVariant* effect,
                            const Eigen::VectorXd& values,
                            double hopeless_cost = std::numeric_limits<double>::infinity());

// Continues a fit that has not converged from where it has ended, as long as it gains and its cost
// does not exceed `hopeless_cost`, within the budget of one effect (RefitThresholds::
// most_of_effect). `predictions`: those that were made for this effect before this fit. A fit that
// cannot be continued stays as it is. Throws Interrupted.
EffectRefit ContinueWithinBudget(const RefitSetting& setting, const ScoredVariant* effect,
                                 EffectRefit refit,
                                 double hopeless_cost = std::numeric_limits<double>::infinity(),
                                 int predictions = 0);

// The refit without an effect, continued if it has not converged (ContinueWithinBudget). Throws
// Interrupted.
EffectRefit RefitWithout(const RefitSetting& setting);

// A refit beside other nuisances, at the parameters that were best for the fitted frames.
struct MovedRefit {
  EffectRefit refit;
  // The log evidence that the best change of its parameters would gain, to first order.
  double gain_in_reach = 0;
  FirstStep first_step = {};  // of a fit from there
};
// Moves a refit to the parameters that are best beside the nuisances of `setting`; nothing is
// predicted. Its estimates stay those of its fit. `noise`: in which the gain is measured.
MovedRefit MovedBeside(const RefitSetting& setting, const ScoredVariant& effect, EffectRefit refit,
                       const NoiseLevel& noise);

// A refit moved as by MovedBeside() and settled from there with the Jacobian that the refit has,
// which takes a few predictions without derivatives.
EffectRefit SettledBeside(const RefitSetting& setting, const ScoredVariant& effect,
                          EffectRefit refit);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EFFECT_REFIT_H_
