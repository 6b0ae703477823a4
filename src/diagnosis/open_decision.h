// The part of a diagnosis in which further fits may still change the decision: refits of what would
// be stated without one, the columns along the motion of the best hypothesis, and pairs of effects.
#ifndef LACUNA_DIAGNOSIS_OPEN_DECISION_H_
#define LACUNA_DIAGNOSIS_OPEN_DECISION_H_

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "diagnosis/decision.h"
#include "diagnosis/diagnosis_result.h"
#include "diagnosis/refits.h"
#include "record/effect_card.h"

namespace lacuna {

// Two effects that may be missing together. A pair is fitted from the refit of the first one.
struct PairToFit {
  std::string first, further;
  // Of a rival of another pair: the evidence that the replacement of one effect costs, to first
  // order beside the first effect where that stays, else between the refits of the two first
  // effects alone.
  double lost = 0;
};

// A decision that further fits may still change, with everything from which it is made. References
// and pointers must outlive it.
struct OpenDecision {
  const RefitContext& context;
  const std::vector<std::string>& without;  // types of effects that are not tried
  RefittedRanking* ranked;
  RefitNoise* noise;
  Diagnosis* diagnosis;  // its decision_input and nuisances are set
  Decision decision;

  const HypothesisProbability& Best() const { return decision.record.probabilities.front(); }
  // Decides upon what has been fitted, and refits what the decision would state without a refit,
  // and so on: only refits are believed. Throws Interrupted, as do the functions below.
  void DecideAgain();
};

// Where an effect is most probable, decides anew with the columns of its own motion and, where that
// is a pair, with the fit of both, until this has been done for the most probable hypothesis.
void RankAlongBest(OpenDecision* open);

// If the most probable hypothesis is a pair that was fitted, fits its rivals as well. The
// first-order value of a pair is kept low on purpose (combinations.cc), so that a fitted pair would
// have an advantage over them.
void FitRivalPairs(OpenDecision* open);

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

#endif  // LACUNA_DIAGNOSIS_OPEN_DECISION_H_
