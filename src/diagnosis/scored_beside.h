// The first-order scores of effects beside a refitted model.
#ifndef LACUNA_DIAGNOSIS_SCORED_BESIDE_H_
#define LACUNA_DIAGNOSIS_SCORED_BESIDE_H_

#include <vector>

#include "diagnosis/hypothesis_space.h"
#include "diagnosis/scored_effect.h"

namespace lacuna {

// The effects with the evidence that first order gives each of their variants beside the base of
// `space`, where that is less, and in that order; so are the variants of each effect. `effects` are
// all effects of the space; their penalties for having been selected among variants and effects
// stay the same.
std::vector<ScoredEffect> ScoredBeside(const HypothesisSpace& space,
                                       std::vector<ScoredEffect> effects);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_SCORED_BESIDE_H_
