// Every effect that a fitted model may lack, tried along its trajectory to first order.
#ifndef LACUNA_STUDY_EFFECT_RANKING_H_
#define LACUNA_STUDY_EFFECT_RANKING_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "analysis/effect_score.h"
#include "core/progress.h"
#include "study/calibration_problem.h"
#include "study/candidates.h"

namespace lacuna {

// One effect, in the best of its variants.
struct ScoredEffect {
  CandidateEffect candidate;
  EffectScore score;  // evidence already less the price of having tried several
  std::vector<std::string> parameters, units;  // of score.size
  std::vector<std::string> look_alikes;        // effects that first order cannot tell from this one
};

struct EffectRanking {
  std::vector<ScoredEffect> effects;  // by evidence, the best first
  double mesh_share = 0;              // of the residual that a finer mesh and step would explain
  int variants = 0;                   // scored in all
};

// Of the study fitted to `values` (CalibrationProblem::parameters). The direction in which a finer
// mesh and step change the residual is projected out before. Throws Interrupted.
EffectRanking RankEffects(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_STUDY_EFFECT_RANKING_H_
