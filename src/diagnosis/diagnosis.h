// Which physical effect a fitted model lacks.
//
// 1. Every effect of the catalogue, and every nuisance that may pass for one, is tried on the
//    fitted trajectory to first order, all in one tangent-linear run, and scored by the evidence
//    for it (diagnosis/effect_ranking.h); what has no derivative, in a pilot run of its own
//    (diagnosis/pilot_hypotheses.h).
// 2. The best effects are added to the model one at a time and fitted with it. What counts is the
//    evidence of all frames, those that were not fitted among them, with noise that is no smaller
//    and no less correlated than what the best of them leaves.
// 3. A control runs the scoring on that remainder, shuffled so that no effect is in it: an effect
//    must do better than what the control finds.
// 4. The verdict says what this allows to say, no more.
// docs/diagnosis.md explains the method and its limits.
#ifndef LACUNA_DIAGNOSIS_DIAGNOSIS_H_
#define LACUNA_DIAGNOSIS_DIAGNOSIS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "core/progress.h"
#include "diagnosis/diagnosis_result.h"
#include "diagnosis/refit_store.h"

namespace lacuna {

struct DiagnosisOptions {
  int refits = 3;  // of the best scored effects; more: slower, a wrong ranking is forgiven
  std::vector<std::string> without;  // effects that are not to be considered
};

// Of the study fitted to `fitted` (CalibrationProblem::parameters). Where the study leaves its step
// open, and what is not known of the step's error could lend an effect its evidence, the study is
// fitted and diagnosed with shorter steps. `kept`: where fits are kept, so that one that is stopped
// goes on there. Throws Interrupted.
Diagnosis Diagnose(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                   const DiagnosisOptions& options, Progress* progress, RefitStore* kept = nullptr);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DIAGNOSIS_H_
