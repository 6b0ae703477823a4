// Every effect that a fitted model may lack, and every nuisance that may look like one, tried along
// its trajectory to first order.
#ifndef LACUNA_STUDY_EFFECT_RANKING_H_
#define LACUNA_STUDY_EFFECT_RANKING_H_

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "core/progress.h"
#include "study/calibration_problem.h"
#include "study/candidates.h"
#include "study/hypothesis_score.h"
#include "study/linear_misfit.h"
#include "study/nuisance_candidates.h"
#include "study/pilot_hypotheses.h"

namespace lacuna {

// Of having tried so many rivals, as a logarithm of odds.
double Price(size_t rivals);

// An effect in one of its variants.
struct ScoredVariant {
  CandidateEffect candidate;
  Score score;
  Eigen::VectorXd fitted;  // what the problem's parameters would become with it
};

// An effect in the best of its variants.
struct ScoredEffect : ScoredVariant {
  std::vector<std::string> parameters, units;  // of score.size
  std::vector<std::string> look_alikes;        // effects that first order cannot tell from this one
  // Other variants that are better than their neighbours along their line, the best first: softer
  // here may look like stiffer there.
  std::vector<ScoredVariant> elsewhere;
};

struct ScoredNuisance {
  NuisanceCandidate candidate;
  double evidence = 0;                  // to first order
  std::optional<double> refitted = {};  // once the model with it has been fitted again
  double explained = 0;
  bool adopted = false;  // it is so certain that the model is taken with it from here on
  // Evidence that what is unknown of its change (NuisanceCandidate::unknown) could lend to an
  // effect.
  double doubt = 0;
};

// Columns of nuisances that are part of the model, in rows of a LinearisedMisfit.
struct AdoptedNuisances {
  Eigen::MatrixXd by;
  std::vector<LinearPrior> priors;
  Eigen::Index always = 0;  // the first columns, which every model has

  AdoptedNuisances Always() const;
  AdoptedNuisances And(const NuisanceCandidate& nuisance) const;
  bool HasMore() const { return by.cols() > always; }
};

// What a variant of an effect, or a nuisance, would change, in rows of a LinearisedMisfit.
struct TriedVariant {
  std::string type;
  Eigen::MatrixXd by;
  std::vector<LinearPrior> priors;
  double price = 0;  // of having tried its rivals too
  bool is_nuisance = false;
};

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

#endif  // LACUNA_STUDY_EFFECT_RANKING_H_
