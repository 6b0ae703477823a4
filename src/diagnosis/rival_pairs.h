// Which pairs of effects a diagnosis fits. All functions are pure.
#ifndef LACUNA_DIAGNOSIS_RIVAL_PAIRS_H_
#define LACUNA_DIAGNOSIS_RIVAL_PAIRS_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/refitted_ranking.h"
#include "record/decision_record.h"
#include "record/effect_card.h"

namespace lacuna {

// Two effects that may be missing together. A pair is fitted from the refit of the first one.
struct PairToFit {
  std::string first, further;
  // The evidence that the replacement of one effect costs, for a rival of another pair: to first
  // order beside the first effect where that stays, else between the refits of the two first
  // effects alone.
  double lost = 0;
};

// Whether the model was fitted with these two effects.
bool IsFitted(const std::vector<FittedPair>& pairs, const std::string& a, const std::string& b);

// The pair with an effect first that has a usable refit; nothing if neither has one: such a pair
// cannot be fitted, but stays a hypothesis to first order.
std::optional<PairToFit> FromARefit(PairToFit pair, const RefittedRanking& ranked);

// The pairs in which another effect of its family replaces one effect of `pair`, and which have not
// been fitted, by what the replacement costs, the least first. An effect that the held-out frames
// refute may become the further one of a pair, which is judged by its own prediction, but not the
// first one. `ranked` has columns along the motion of a refit.
std::vector<PairToFit> RivalsOf(const HypothesisProbability& pair, const RefittedRanking& ranked,
                                const std::map<std::string, EffectFamily>& families);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_RIVAL_PAIRS_H_
