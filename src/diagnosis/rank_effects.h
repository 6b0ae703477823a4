// Ranks every effect that a fitted model may lack, beside every nuisance that may imitate one, by
// first-order evidence along the fitted trajectory.
//
// All hypotheses are columns of one linear Gaussian model (hypothesis_columns.h), and each of them
// is scored beside those that the model has (hypothesis_score.h). A nuisance whose evidence exceeds
// that of the best effect by RankingThresholds::nuisance_lead is adopted: it becomes part of the
// model, and the rest is scored again.
#ifndef LACUNA_DIAGNOSIS_RANK_EFFECTS_H_
#define LACUNA_DIAGNOSIS_RANK_EFFECTS_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "calibration/calibration_problem.h"
#include "core/progress.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/hypothesis_columns.h"
#include "diagnosis/scene_columns.h"

namespace lacuna {

// Ranks the effects of the catalogue, but for the types in `without`, beside the study of `problem`
// with the fitted `values` of CalibrationProblem::parameters. What `known` has is taken from there
// instead of simulated. With `decided`, no nuisance is adopted anew. Throws Interrupted.
EffectRanking RankEffects(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          Progress* progress, const std::vector<std::string>& without = {},
                          const SceneColumns& known = {}, const DecidedBase* decided = nullptr);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_RANK_EFFECTS_H_
