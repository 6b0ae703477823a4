// The part of a diagnosis in which further fits may still change the decision: refits of what would
// be stated without one, the columns along the motion of the best hypothesis, and pairs of effects.
#ifndef LACUNA_DIAGNOSIS_OPEN_DECISION_H_
#define LACUNA_DIAGNOSIS_OPEN_DECISION_H_

#include <string>
#include <vector>

#include "diagnosis/decision_input.h"
#include "diagnosis/refitted_ranking.h"
#include "diagnosis/scored_effect.h"
#include "diagnosis/variant_refit.h"
#include "record/decision_record.h"

namespace lacuna {

// A decision that further fits may still change, with everything from which it is made. The
// references must outlive it.
struct OpenDecision {
  const RefitContext& context;
  const std::vector<std::string>& without;  // types of effects that are not tried
  RefittedRanking ranked;
  RefitNoise noise;  // with which `ranked` has been weighed
  std::vector<ScoredNuisance> nuisances;
  // Set by DecideAgain().
  DecisionInput input = {};
  std::vector<HypothesisProbability> posterior = {};  // PosteriorOf(input)

  const HypothesisProbability& Best() const { return posterior.front(); }
  // Weighs what has been fitted, and refits what would be stated without a refit, and so on: only
  // refits are believed. Throws Interrupted, as do the functions below.
  void DecideAgain();
};

// Where an effect is most probable, decides anew with the columns of its own motion and, where that
// is a pair, with the fit of both, until this has been done for the most probable hypothesis.
void RankAlongBest(OpenDecision* open);

// If the most probable hypothesis is a pair that was fitted, fits its rivals as well. The
// first-order value of a pair is kept low on purpose (combinations.cc), so that a fitted pair would
// have an advantage over them.
void FitRivalPairs(OpenDecision* open);

}  // namespace lacuna

#endif  // LACUNA_DIAGNOSIS_OPEN_DECISION_H_
