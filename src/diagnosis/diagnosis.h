// Diagnoses which physical effect a fitted model lacks.
//
// 1. Every effect of the catalogue, and every nuisance that may imitate one, is ranked by its
//    first-order evidence along the fitted trajectory (rank_effects.h).
// 2. The best effects are added to the model, one at a time, and fitted with it (refits.h). What
//    counts is the evidence of all frames, including the held-out ones, with a noise that is at
//    least as large and as correlated as the residual of the best-fitting model: the one with the
//    smallest residual among the model as it is and all refits, with one effect or two, that the
//    held-out frames do not refute.
// 3. The decision weighs all hypotheses, tests whether the most probable one leaves more than
//    noise, and simulates what these recordings would have shown (decision.h, recording_power.h).
// 4. The verdict states the result in terms to act upon (verdict.h).
// docs/diagnosis.md explains the method and its limits.
#ifndef LACUNA_DIAGNOSIS_DIAGNOSIS_H_
#define LACUNA_DIAGNOSIS_DIAGNOSIS_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "calibration/fit_store.h"
#include "core/progress.h"
#include "diagnosis/decision_input.h"
#include "diagnosis/diagnosis_result.h"

namespace lacuna {

struct DiagnosisOptions {
  int refits = 3;  // number of effects to refit; more: slower, a wrong ranking is corrected
  std::vector<std::string> without;  // types of effects that are not considered
};

// Diagnoses the study of `problem` with its `fitted` parameters, in the order of
// CalibrationProblem::parameters. If the study leaves the time step open, and the uncertainty in
// the error of the step could explain the evidence for an effect, the study is fitted and diagnosed
// again with a shorter step. `kept`: where fits are kept, so that an interrupted diagnosis
// continues there; null: they are not kept. `other_mesh`: what the fit has found about the mesh
// (KnownErrors); empty: nothing. Throws Interrupted.
Diagnosis Diagnose(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                   const DiagnosisOptions& options, Progress* progress, FitStore* kept = nullptr,
                   const std::optional<OtherMesh>& other_mesh = {});

// What a decision without any refit of an effect would be made from, with all effects of the
// catalogue. Throws Interrupted.
DecisionInput FirstOrderInput(const CalibrationProblem& problem, const Eigen::VectorXd& fitted,
                              Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_DIAGNOSIS_H_
