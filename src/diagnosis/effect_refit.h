// A fitted model with one more effect, fitted again: what first order has said, put to the test.
#ifndef LACUNA_DIAGNOSIS_EFFECT_REFIT_H_
#define LACUNA_DIAGNOSIS_EFFECT_REFIT_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/extended_problem.h"
#include "record/model_errors.h"

namespace lacuna {

// The errors of a model with these parameter values, over all recordings.
ModelErrors ErrorsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values);

// A model about its best parameters, and what it leaves of the measurements there.
struct FittedHypothesis {
  LinearisedMisfit misfit;          // columns: the problem's parameters, then what was adopted
  std::vector<LinearPrior> priors;  // of the columns
  Eigen::Index parameters = 0;      // how many of the columns are the problem's
  Eigen::VectorXd left;             // what it leaves with the best amounts of what was adopted, m
};

// ln p of all frames of the fitted recordings, up to what all hypotheses share, with the parameters
// where they are (linear_evidence.h has them at their best to first order: that would reward a fit
// that has not converged).
struct HypothesisEvidence {
  double log_evidence = 0;
  double misfit = 0;  // ‖whitened left‖²
};
// `fitted_only`: of the frames that were fitted.
HypothesisEvidence EvidenceOf(const FittedHypothesis& hypothesis, const NoiseLevel& noise,
                              bool fitted_only = false);

struct EffectRefit {
  std::string message;  // why it is not usable; empty: it is
  Calibration calibration;
  Eigen::VectorXd effect;                // parameters of the effect there, in the order of its card
  std::vector<ParameterEstimate> sizes;  // of those that make its size; none of a pilot
  std::vector<NamedEstimate> others;     // of the others that were fitted: its place, its time
  ModelErrors errors;
  // At the parameters that are best for the fitted frames, and for all.
  FittedHypothesis at_fit, hypothesis;
};

// ln p of all frames, and of the held-out ones alone once the fitted ones are known. That weighs
// how well a model predicts by how well it claims to: a parameter that the fitted frames leave open
// costs no more than it must.
struct RefitEvidence {
  double all = 0, held_out = 0;
  double misfit = 0;  // as HypothesisEvidence, of all frames
};
RefitEvidence EvidenceOf(const EffectRefit& refit, const NoiseLevel& noise);

// The best of the effects that a refit leaves evidence for, to first order: with the changes that
// they make at the model without the refitted one, less the price of trying them all. And what it
// leaves for the best of the nuisances.
struct FurtherEvidence {
  std::string type;
  double evidence = 0;  // 0 and no type: none
  double of_nuisance = 0;
};
// Of all but `type`, the refitted one.
FurtherEvidence FurtherEvidenceOf(const FittedHypothesis& hypothesis,
                                  const std::vector<TriedVariant>& tried, const std::string& type,
                                  const NoiseLevel& noise);

// The same along the refitted model's own motion, with its own mesh and step: what a diagnosis of
// it would find, at the price of its ranking. Leaves the study's effects at the present values.
// Throws Interrupted.
FurtherEvidence FurtherEvidenceAlong(const PresentModel& present, const ScoredVariant& effect,
                                     const EffectRefit& refit,
                                     const std::vector<std::string>& without);

// Where a refit begins: where first order expects the best parameters; or with the effect at the
// size that it expects, and everything else fitted to that.
enum class RefitFrom { kFirstOrder, kItsSize };

// It has found less than half of the evidence that first order promises: a minimum on the way, or a
// promise that is none. The latter where it explains most of what is more than `noise`, the misfit
// that is expected of noise; but the noise is estimated, and what it has left over by a model that
// is about as good says nothing.
bool FallsShort(const HypothesisEvidence& without, const HypothesisEvidence& refit, double noise,
                double promised);

// What follows the fitted frames with an effect, and misses the held-out ones by more than without
// it, has its parameters in the wrong place.
bool PredictsWorse(const ModelErrors& with, const ModelErrors& without);

// From where first order expects the best parameters, or from the present ones where that is
// nearer, or part of the way where neither predicts as well as the model without the effect. Null
// `effect`: the model as it is, with what was adopted, so that it is compared at its best too.
// Leaves the study's effects at the present values. `is_far_off`: so is the model as it is, and a
// refit from there that leaves more than noise is made again from where the model with the effect
// ends when it is fitted afresh. Throws Interrupted.
EffectRefit Refit(const PresentModel& present, const ScoredVariant* effect,
                  const AdoptedNuisances& adopted, bool is_far_off,
                  RefitFrom from = RefitFrom::kFirstOrder);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EFFECT_REFIT_H_
