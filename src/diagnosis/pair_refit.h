// Two effects at once: a refitted effect, along whose motion everything else is ranked, and the fit
// of the model with that effect and a further one.
//
// The residual of a refit may be a hundredth of what its effect explains. The columns of the mesh
// and the time step must therefore be computed along the motion with that effect. All pairs of a
// diagnosis are fitted beside the same columns and compared with the same measured points, so that
// their evidence can be compared.
#ifndef LACUNA_DIAGNOSIS_PAIR_REFIT_H_
#define LACUNA_DIAGNOSIS_PAIR_REFIT_H_

#include <optional>
#include <string>
#include <vector>

#include "diagnosis/effect_refit.h"
#include "diagnosis/extended_problem.h"
#include "diagnosis/rank_effects.h"
#include "diagnosis/refitted_ranking.h"

namespace lacuna {

// Everything but the types in `without`, ranked along the motion of the refit of `effect`, with the
// nuisances that `decided`, the baseline's ranking, has adopted. The effect keeps its size in the
// columns. A nuisance that cannot be simulated along that motion keeps its columns along the
// baseline's, which the progress says. Pilots are simulated again only if the effect is one of
// them, so that it does not stand beside itself. Throws Interrupted.
EffectRanking RankAlong(const BaselineModel& baseline, const ScoredVariant& effect,
                        const EffectRefit& refit, const std::vector<std::string>& without,
                        const DecidedBase& decided);

// Fits the model with `first`, from its refit, and with a further effect, from its place, direction
// and time in `ranking`, beside the nuisances and with the noise of that ranking, as the refit was.
// `is_along_first`: the ranking is along the motion of this refit; otherwise, of one with another
// effect. Nothing if the pair cannot be fitted. Throws Interrupted.
std::optional<FittedPair> FitPair(const BaselineModel& baseline, const ScoredVariant& first,
                                  const EffectRefit& refit, const std::string& further,
                                  const EffectRanking& ranking, bool is_along_first);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_PAIR_REFIT_H_
