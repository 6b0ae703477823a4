// The ranking of the effects that a fitted model may lack, by first-order evidence, as a value
// (rank_effects.h makes it), and the space of its hypotheses beside another base.
#ifndef LACUNA_DIAGNOSIS_EFFECT_RANKING_H_
#define LACUNA_DIAGNOSIS_EFFECT_RANKING_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "diagnosis/hypothesis_space.h"
#include "diagnosis/scene_columns.h"
#include "diagnosis/scored_effect.h"
#include "record/agreement_record.h"
#include "record/model_errors.h"

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
  int variants = 0;               // number of variants scored
  SceneColumns scene;             // for further rankings
  AgreementRecord agreement;      // of the recordings, along the fitted motion

  // Half of the squared length, in units of the noise, of the error that the model may have in any
  // direction (HypothesisSpace::model_error).
  double ModelError() const;
  // The effect of this type; null: it was not ranked.
  const ScoredEffect* Find(const std::string& type) const;
};

// The columns of everything that a ranking has tried, whitened with one noise, and their products:
// what the spaces beside different bases have in common.
class WhitenedHypotheses {
 public:
  // `misfit`: has the rows of all columns, and must outlive this, as must the ranking.
  WhitenedHypotheses(const EffectRanking& ranking, const LinearisedMisfit& misfit,
                     const NoiseLevel& noise);

  // Whether rows of this misfit are whitened in the same way, as Beside() needs.
  bool WhitensLike(const LinearisedMisfit& misfit) const;
  // The space of all hypotheses that the ranking has tried, as SpaceBeside() says.
  HypothesisSpace Beside(const LinearisedMisfit& misfit, const Eigen::MatrixXd& base,
                         const std::vector<LinearPrior>& priors,
                         const std::vector<std::string>& without,
                         bool base_has_adopted = true) const;

  const EffectRanking& ranking() const { return ranking_; }

 private:
  struct Tried {
    WeighedHypothesis hypothesis;  // its columns are indices in `columns_`
    bool is_adopted = false;
  };
  void Add(Tried tried, Eigen::Index width);

  const EffectRanking& ranking_;
  const LinearisedMisfit& misfit_;
  NoiseLevel noise_;
  std::vector<Tried> tried_;  // without those that have no columns
  Eigen::MatrixXd columns_;
  Eigen::MatrixXd products_;
  std::vector<LinearPrior> priors_;
};

// The space of all hypotheses that a ranking has tried, beside the columns `base` (m, the rows of
// `misfit`) with these priors, for the residual of `misfit`. `without`: types of effects that are
// left out, because they are part of the base. `base_has_adopted`: so are the adopted nuisances;
// otherwise they are hypotheses like the others.
HypothesisSpace SpaceBeside(const LinearisedMisfit& misfit, const Eigen::MatrixXd& base,
                            const std::vector<LinearPrior>& priors, const EffectRanking& ranking,
                            const std::vector<std::string>& without, const NoiseLevel& noise,
                            bool base_has_adopted = true);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_EFFECT_RANKING_H_
