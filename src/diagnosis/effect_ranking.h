// Every effect that a fitted model may lack, and every nuisance that may look like one, tried along
// its trajectory to first order.
#ifndef LACUNA_DIAGNOSIS_EFFECT_RANKING_H_
#define LACUNA_DIAGNOSIS_EFFECT_RANKING_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "core/progress.h"
#include "diagnosis/hypothesis_score.h"
#include "diagnosis/pilot_hypotheses.h"
#include "diagnosis/scored_effect.h"

namespace lacuna {

// Of having tried so many rivals, as a logarithm of odds.
double Price(size_t rivals);

struct EffectRanking {
  std::vector<ScoredEffect> effects;  // by evidence, the best first
  // All variants of all effects, and the nuisances that are not in the model.
  std::vector<TriedVariant> tried;
  // Where nuisances were adopted beyond those that every model has: the effects as they stand
  // without, by evidence.
  std::vector<ScoredEffect> instead;
  std::vector<UntriedEffect> untried;
  std::vector<ScoredNuisance> nuisances;  // discretisation, grips, measurement
  AdoptedNuisances adopted;
  NoiseLevel noise;
  LinearisedMisfit misfit;  // at the fitted values, without columns of hypotheses
  // The evidence that one in twenty controls finds: what the best hypothesis leaves, its frames
  // moved along and its signs drawn anew, so that no effect is in it.
  double control = 0;
  int variants = 0;  // scored in all
};

// Of the study fitted to `values` (CalibrationProblem::parameters), of the whole catalogue but the
// types in `without`. Throws Interrupted.
EffectRanking RankEffects(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          Progress* progress, const std::vector<std::string>& without = {});

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EFFECT_RANKING_H_
