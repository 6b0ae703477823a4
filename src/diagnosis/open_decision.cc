#include "diagnosis/open_decision.h"

#include <glog/logging.h>

#include <algorithm>
#include <optional>
#include <utility>

#include "diagnosis/combinations.h"
#include "diagnosis/decision.h"
#include "diagnosis/decision_maker.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/nuisance_refits.h"
#include "diagnosis/pair_refit.h"
#include "diagnosis/rank_effects.h"
#include "diagnosis/refit_comparison.h"
#include "diagnosis/refits.h"
#include "diagnosis/rival_pairs.h"

namespace lacuna {
namespace {

using Kind = HypothesisProbability::Kind;

// RankAlongBest() computes columns anew or fits a pair so many times at most. Higher: slower, where
// several hypotheses are nearly equal.
constexpr int kMostSteps = 4;
// The largest number of pairs that FitRivalPairs() fits. Higher: slower, where many members of a
// family explain the same residual.
constexpr int kMostRivalPairs = 3;

// The effects that the hypotheses of a statement contain, but that were not refitted.
std::vector<size_t> WithoutRefit(const std::vector<HypothesisProbability>& posterior,
                                 const RefittedRanking& ranked) {
  std::vector<size_t> effects;
  for (const size_t k : NameFrom(posterior).kept)
    for (const std::string& name : posterior[k].names)
      for (size_t e = 0; e < ranked.effects.size(); ++e)
        if (ranked.effects[e].scored.candidate.type == name && !ranked.effects[e].refitted)
          effects.push_back(e);
  return effects;
}

// Ranks everything anew along the motion of the refit with this effect. Returns whether there is
// such a refit.
bool RankAlongRefit(const std::string& effect, OpenDecision* open) {
  RefittedRanking& ranked = open->ranked;
  const std::optional<size_t> k = ranked.FindUsable(effect);
  if (!k) return false;
  LookAlong(open->context, effect,
            RankAlong(open->context.model, ranked.effects[*k].scored, ranked.refits[*k],
                      open->without, DecidedBase{open->context.ranking, open->noise.level}),
            &ranked);
  open->noise = WeighRefits(open->context, &ranked);
  return true;
}

// Fits a pair of which one effect has a usable refit, beside the columns along the motion of a
// refit, and decides again. A pair that cannot be fitted is no hypothesis any more.
void AddPair(const PairToFit& wanted, OpenDecision* open) {
  RefittedRanking& ranked = open->ranked;
  const std::optional<size_t> k = ranked.FindUsable(wanted.first);
  CHECK(k && ranked.along);
  std::optional<FittedPair> pair =
      FitPair(open->context.model, ranked.effects[*k].scored, ranked.refits[*k], wanted.further,
              *ranked.along->ranking, wanted.first == ranked.along->type);
  if (!pair) {
    ranked.failed_pairs.push_back({wanted.first, wanted.further});
    open->DecideAgain();
    return;
  }
  // With the help of the second effect, the fit may have found better parameters for the first one,
  // alone, too. The pair must not count that for the second effect.
  RefitAgain(open->context, *k, pair->values_of_first, open->noise.level, &ranked);
  ranked.pairs.push_back(*std::move(pair));
  open->noise = WeighRefits(open->context, &ranked);
  open->DecideAgain();
}

}  // namespace

void OpenDecision::DecideAgain() {
  for (;;) {
    WeighNuisances(ranked, noise, &nuisances);
    input = MakeDecisionInput(context, ranked, noise, nuisances);
    posterior = PosteriorOf(input);
    const int before = ranked.count;
    RefitAll(context, WithoutRefit(posterior, ranked), &ranked);
    if (ranked.count == before) return;
    noise = WeighRefits(context, &ranked);
  }
}

void RankAlongBest(OpenDecision* open) {
  const RefittedRanking& ranked = open->ranked;
  for (int step = 0; step < kMostSteps; ++step) {
    const HypothesisProbability best = open->Best();
    if (best.kind != Kind::kEffect && best.kind != Kind::kPair) break;
    if (!ranked.along || !best.Contains(ranked.along->type)) {
      if (!RankAlongRefit(best.names.front(), open)) break;
      open->DecideAgain();
    } else if (best.kind == Kind::kPair && !IsFitted(ranked.pairs, best.names[0], best.names[1])) {
      const bool is_first = best.names[0] == ranked.along->type;
      const std::optional<PairToFit> pair =
          FromARefit({ranked.along->type, best.names[is_first ? 1 : 0]}, ranked);
      if (!pair) break;
      AddPair(*pair, open);
    } else {
      break;
    }
  }
}

void FitRivalPairs(OpenDecision* open) {
  const RefittedRanking& ranked = open->ranked;
  for (int fits = 0; ranked.along && fits <= kMostRivalPairs; ++fits) {
    const HypothesisProbability best = open->Best();
    if (best.kind != Kind::kPair) break;
    const DecisionInput& input = open->input;
    std::vector<PairToFit> next;
    if (!IsFitted(ranked.pairs, best.names[0], best.names[1])) {
      // Another pair has become the most probable one.
      if (const auto pair = FromARefit({best.names[0], best.names[1]}, ranked))
        next.push_back(*pair);
    } else if (fits < kMostRivalPairs) {
      const double hopeless = DecisiveLead(best.evidence);
      for (const PairToFit& rival : RivalsOf(best, ranked, input.families))
        if (const auto pair = FromARefit(rival, ranked); pair && pair->lost <= hopeless)
          next.push_back(*pair);
    }
    std::erase_if(next,
                  [&](const PairToFit& one) { return HasFailed(input, one.first, one.further); });
    if (next.empty()) break;
    AddPair(next.front(), open);
  }
}

}  // namespace lacuna
