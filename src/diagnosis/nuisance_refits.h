// The nuisances of a diagnosis, judged by refits as the effects are: fits of the model with a
// nuisance, and with an effect in place of the nuisances that the ranking has adopted.
#ifndef LACUNA_DIAGNOSIS_NUISANCE_REFITS_H_
#define LACUNA_DIAGNOSIS_NUISANCE_REFITS_H_

#include <vector>

#include "diagnosis/diagnosis_result.h"
#include "diagnosis/refitted_ranking.h"
#include "diagnosis/scored_effect.h"
#include "diagnosis/variant_refit.h"

namespace lacuna {

// Refits the model with each nuisance that first order puts near the best effect (BestRefitted) or
// above it; none if no effect has evidence. Throws Interrupted.
void RefitRivalNuisances(const RefitContext& context, RefittedRanking* ranked);

// Sets ScoredNuisance::refitted of the nuisances that were refitted. A refit that has not converged
// has found less than the nuisance can explain, so that first order counts where that is more.
void WeighNuisances(const RefittedRanking& ranked, const RefitNoise& noise,
                    std::vector<ScoredNuisance>* nuisances);

// Refits `wanted` effects, at most, in place of the adopted nuisances. Throws Interrupted.
NuisanceAlternatives RefitInPlaceOfNuisances(const RefitContext& context,
                                             const RefittedRanking& ranked, const RefitNoise& noise,
                                             int wanted);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_NUISANCE_REFITS_H_
