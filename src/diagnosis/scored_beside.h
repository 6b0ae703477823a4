// The first-order scores of effects beside a refitted model.
#ifndef LACUNA_DIAGNOSIS_SCORED_BESIDE_H_
#define LACUNA_DIAGNOSIS_SCORED_BESIDE_H_

#include <vector>

#include "diagnosis/effect_ranking.h"
#include "diagnosis/fitted_hypothesis.h"
#include "diagnosis/hypothesis_space.h"
#include "diagnosis/scored_effect.h"

namespace lacuna {

// The effects with the evidence that first order gives each of their variants beside the base of
// `space`, where that is less, and in that order; so are the variants of each effect. `effects` are
// all effects of the space; their penalties for having been selected among variants and effects
// stay the same.
std::vector<ScoredEffect> ScoredBeside(const HypothesisSpace& space,
                                       std::vector<ScoredEffect> effects);

// The effects as first order scores them beside the refitted baseline. The first scores count from
// the fit as it was, which the nuisances of every model may improve by more than any effect does. A
// fit that is far from the measurements is left as it is: there, the columns of these nuisances are
// differences of motions out of phase, which explain much and mean little. `base_has_adopted`: the
// baseline contains the nuisances that the ranking has adopted.
std::vector<ScoredEffect> ScoredBesideRefit(const FittedHypothesis& baseline,
                                            const EffectRanking& ranking,
                                            std::vector<ScoredEffect> effects,
                                            bool base_has_adopted);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_SCORED_BESIDE_H_
