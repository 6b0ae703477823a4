// A shorter time step for a diagnosis, where the error of the step could look like an effect.
#ifndef LACUNA_DIAGNOSIS_STEP_REFINEMENT_H_
#define LACUNA_DIAGNOSIS_STEP_REFINEMENT_H_

#include <Eigen/Core>
#include <memory>
#include <optional>

#include "calibration/calibration_problem.h"
#include "diagnosis/effect_ranking.h"

namespace lacuna {

class Progress;

// The study of the same recordings with a shorter time step, and its problem.
struct ShorterStep {
  std::unique_ptr<const PredictionStudy> study;
  std::unique_ptr<const CalibrationProblem> problem;  // of `study`
  Eigen::VectorXd values;                             // the fitted ones
};

// Halves the time step until the unknown part of its error, as far as the parameters cannot
// compensate for it, could contribute only little evidence to an effect: less than
// RefitThresholds::uncertain_step_evidence, less than the unknown part of the mesh's error, which
// remains however short the step, or less than the share of the best effect's evidence that the
// decision tolerates as an error of the model (kToleratedModelError). Nothing where no effect has
// evidence, where the step is short enough, or where a shorter one cannot be fitted. Where the
// error of a shorter step cannot be told, it is the last one. `progress` says why. `ranking`: of
// the effects along the motion of `fitted`; its noise counts for all steps. Throws Interrupted.
std::optional<ShorterStep> ShortenStep(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& fitted, const EffectRanking& ranking,
                                       Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_STEP_REFINEMENT_H_
