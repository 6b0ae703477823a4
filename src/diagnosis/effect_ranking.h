// Ranks every effect that a fitted model may lack, beside every nuisance that may imitate one, by
// first-order evidence along the fitted trajectory.
//
// One tangent-linear simulation gives the changes of the residual by the model's parameters, the
// sizes of all effects in all their variants, and the motions of the grips. Effects without a
// derivative are simulated by themselves (pilot_hypotheses.h), and so are the nuisances of the
// mesh, the time step and the shape (nuisance_catalogue.h). All of them become columns of one
// linear Gaussian model (hypothesis_score.h).
//
// A nuisance whose evidence exceeds that of the best effect by RankingThresholds::nuisance_lead is
// adopted: it becomes part of the model, and the rest is scored again.
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
#include "diagnosis/hypothesis_space.h"
#include "diagnosis/pilot_hypotheses.h"
#include "diagnosis/scene_columns.h"
#include "diagnosis/scored_effect.h"
#include "record/agreement_record.h"

namespace lacuna {

// ln n: the evidence that the best of n rivals must give up for having been selected. 0 for none.
double SelectionPenalty(size_t rivals);

struct EffectRanking {
  std::vector<ScoredEffect> effects;  // the most evidence first
  // All variants of all effects, and the nuisances that are not part of the model.
  std::vector<TriedVariant> tried;
  // The effects as they are ranked without the adopted nuisances (those of every model excepted);
  // empty if none was adopted.
  std::vector<ScoredEffect> without_adopted;
  std::vector<UntriedEffect> untried;     // and nuisances, by the names of their cards
  std::vector<ScoredNuisance> nuisances;  // in the order of the catalogue
  AdoptedNuisances adopted;
  NoiseLevel noise;
  double explained_misfit = 0;    // as PredictionStudy has it
  LinearisedMisfit misfit;        // at the fitted values, without columns
  Eigen::MatrixXd unknown_force;  // the columns of UnknownForceColumns (unknown_force.h)
  HypothesisSpace space;          // of all hypotheses beside the parameters and adopted nuisances
  int variants = 0;               // number of variants scored
  SceneColumns scene;             // for further rankings
  AgreementRecord agreement;      // of the recordings, along the fitted motion

  // Half of the squared length, in units of the noise, of the error that the model may have in any
  // direction (HypothesisSpace::model_error).
  double ModelError() const;
  // The effect of this type; null: it was not ranked.
  const ScoredEffect* Find(const std::string& type) const;
};

// The space of all hypotheses that a ranking has tried, beside the columns `base` (m, the rows of
// `misfit`) with these priors, for the residual of `misfit`. `without`: types of effects that are
// left out, because they are part of the base. `base_has_adopted`: so are the adopted nuisances;
// otherwise they are hypotheses like the others.
HypothesisSpace SpaceBeside(const LinearisedMisfit& misfit, const Eigen::MatrixXd& base,
                            std::vector<LinearPrior> priors, const EffectRanking& ranking,
                            const std::vector<std::string>& without, const NoiseLevel& noise,
                            bool base_has_adopted = true);

// What an earlier ranking of the same recordings has decided: which nuisances are part of the
// model, beside those of every model, and how large the noise is. The columns of these nuisances
// are those along the motion of the new ranking; one that cannot be made there, such as a bad frame
// that is not the worst one along that motion, keeps the columns of the earlier ranking.
struct DecidedBase {
  const EffectRanking& ranking;
  NoiseLevel noise;
};

// Ranks the effects of the catalogue, but for the types in `without`, beside the study of `problem`
// with the fitted `values` of CalibrationProblem::parameters. What `known` has is taken from there
// instead of simulated. With `decided`, no nuisance is adopted anew. Throws Interrupted.
EffectRanking RankEffects(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                          Progress* progress, const std::vector<std::string>& without = {},
                          const SceneColumns& known = {}, const DecidedBase* decided = nullptr);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EFFECT_RANKING_H_
