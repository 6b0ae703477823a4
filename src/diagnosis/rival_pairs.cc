#include "diagnosis/rival_pairs.h"

#include <algorithm>
#include <utility>

#include "diagnosis/decision.h"
#include "diagnosis/thresholds.h"

namespace lacuna {

bool IsFitted(const std::vector<FittedPair>& pairs, const std::string& a, const std::string& b) {
  return std::any_of(pairs.begin(), pairs.end(),
                     [&](const FittedPair& one) { return one.IsOf(a, b); });
}

std::optional<PairToFit> FromARefit(PairToFit pair, const RefittedRanking& ranked) {
  if (!ranked.FindUsable(pair.first)) std::swap(pair.first, pair.further);
  if (!ranked.FindUsable(pair.first)) return std::nullopt;
  return pair;
}

std::vector<PairToFit> RivalsOf(const HypothesisProbability& pair, const RefittedRanking& ranked,
                                const std::map<std::string, EffectFamily>& families) {
  const auto first_order = [&](const std::string& type) {
    const ScoredEffect* effect = ranked.along->ranking->Find(type);
    return effect != nullptr ? effect->score.evidence : 0.0;
  };
  const auto alone = [&](const std::string& type) {
    const std::optional<size_t> k = ranked.FindUsable(type);
    return k ? ranked.effects[*k].evidence : 0.0;
  };
  std::vector<PairToFit> rivals;
  for (const size_t at : {0u, 1u}) {
    const std::string &replaced = pair.names[at], &kept = pair.names[1 - at];
    const EffectFamily family = FamilyOf(families, replaced);
    if (family == EffectFamily::kOther) continue;
    for (const RankedEffect& other : ranked.effects) {
      const std::string& type = other.scored.candidate.type;
      if (pair.Contains(type) || FamilyOf(families, type) != family ||
          IsFitted(ranked.pairs, kept, type))
        continue;
      if (kept == ranked.along->type) {
        if (first_order(type) >= kThresholds.refit.least_evidence)
          rivals.push_back({kept, type, first_order(replaced) - first_order(type)});
      } else if (other.HasUsableRefit() && other.predicts) {
        rivals.push_back({type, kept, alone(replaced) - alone(type)});
      }
    }
  }
  std::stable_sort(rivals.begin(), rivals.end(),
                   [](const PairToFit& a, const PairToFit& b) { return a.lost < b.lost; });
  return rivals;
}

}  // namespace lacuna
