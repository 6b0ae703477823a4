// A fitted model with one more effect, fitted again: what first order has said, put to the test.
#ifndef LACUNA_STUDY_EFFECT_REFIT_H_
#define LACUNA_STUDY_EFFECT_REFIT_H_

#include <Eigen/Core>
#include <string>

#include "core/progress.h"
#include "study/calibration_problem.h"
#include "study/effect_ranking.h"

namespace lacuna {

// How far a model is from the measurements, over all recordings.
struct ModelErrors {
  double in_fit_rms = 0, held_out_rms = 0;  // m, of marker distances
  double in_noise = 0;                      // held out, in σ
  bool has_held_out = false;                // false: the fitted frames stand for them
};
ModelErrors ErrorsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values);

// A model about its best parameters, and what it leaves of the measurements there.
struct FittedHypothesis {
  LinearisedMisfit misfit;          // columns: the problem's parameters, then what was adopted
  std::vector<LinearPrior> priors;  // of the columns
};

// ln p of all frames of the fitted recordings (linear_evidence.h), up to what all hypotheses share.
LinearFit EvidenceOf(const FittedHypothesis& hypothesis, const NoiseLevel& noise);
// What the hypothesis leaves, rows in m.
Eigen::VectorXd LeftBy(const FittedHypothesis& hypothesis, const NoiseLevel& noise);

// Compared with what `same` was compared with.
FittedHypothesis HypothesisAt(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const AdoptedNuisances& adopted, const LinearisedMisfit& same);

struct EffectRefit {
  std::string message;  // why it is not usable; empty: it is
  Calibration calibration;
  ModelErrors errors;
  FittedHypothesis hypothesis;
};

// The study with the effect in its model, all of whose parameters are fitted, within what its card
// calls plausible.
PredictionStudy WithEffect(const PredictionStudy& study, const ScoredEffect& effect);

// From where first order expects the best parameters, or from `values` where that is nearer. Leaves
// the study's effects at `values`. `misfit`: of the model as it is. Throws Interrupted.
EffectRefit Refit(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                  const ScoredEffect& effect, const AdoptedNuisances& adopted,
                  const LinearisedMisfit& misfit, Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_STUDY_EFFECT_REFIT_H_
