// Which of the ranked effects are fitted together with the model, and their fits.
//
// RefitAll() and RefitAsRankedEarly() add refits to a RefittedRanking; LookAlong() fits them anew
// beside the columns of another motion, and RefitAgain() from other values. WeighRefits()
// (refit_comparison.h) computes their evidence.
#ifndef LACUNA_DIAGNOSIS_REFITS_H_
#define LACUNA_DIAGNOSIS_REFITS_H_

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "analysis/linear_evidence.h"
#include "diagnosis/diagnosis_result.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/refitted_ranking.h"
#include "diagnosis/scored_effect.h"
#include "diagnosis/variant_refit.h"

namespace lacuna {

// Fits the model without an effect. No effect is refitted yet; `wanted` is the number of refits
// that the user asks for.
RefittedRanking StartRefits(const RefitContext& context, const std::vector<ScoredEffect>& effects,
                            int wanted);

// The `wanted` best effects by first order, and those that are nearly as good.
std::vector<size_t> MostPromising(const std::vector<RankedEffect>& effects, int wanted);

// The effects that may be taken for the best refitted one (BestRefitted): those that first order
// cannot distinguish from it, and those of its family. None if no effect has evidence.
std::vector<size_t> LookAlikesOfBest(const std::vector<RankedEffect>& effects);

// Refits the effects with these indices that have not been refitted, up to the limit, beside the
// columns of RefittedRanking::along. Effects that another refit has clearly beaten
// (RefitThresholds::beaten_by) are left out, but not those of the best effect's family, unless
// their score comes from a simulation at a finite size: a derivative may give no evidence for the
// member that is really missing.
void RefitAll(const RefitContext& context, const std::vector<size_t>& effects,
              RefittedRanking* ranked);

// Refits the `wanted` best effects of another ranking, `early`, from the places, directions, times
// and sizes that they have there, also those that have been refitted: the better refit counts.
void RefitAsRankedEarly(const RefitContext& context, const std::vector<ScoredEffect>& early,
                        int wanted, RefittedRanking* ranked);

// Puts the columns of `along`, a ranking along the motion of the refit with the effect `type`,
// beside all refits, and fits each of them anew beside these columns, from where it is. Every refit
// that follows the measurements moves like that one, while the baseline, without the effect, may
// move otherwise: its columns of the mesh and the time step are then wrong for all of them, and
// what is wrong looks like a further effect. A refit that was behind the best one by DecisiveLead()
// beside the old columns, and would be beside the new ones even with twice the gain that first
// order promises, or whose cost would stay above HopelessCost() with twice the gain of the first
// full step of a fit, stays where it is. One whose fit has failed is settled (SettledBeside). Both
// count as not converged. Pairs that were fitted beside other columns are dropped, and so are those
// that could not be fitted there. Throws Interrupted.
void LookAlong(const RefitContext& context, const std::string& type, EffectRanking along,
               RefittedRanking* ranked);

// Fits the model with an effect, which has a usable refit, from these values of its parameters,
// beside the columns of RefittedRanking::along, and keeps the better of both fits. Throws
// Interrupted.
void RefitAgain(const RefitContext& context, size_t effect, const Eigen::VectorXd& values,
                const NoiseLevel& noise, RefittedRanking* ranked);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_REFITS_H_
