#include "diagnosis/refitted_ranking.h"

#include <algorithm>
#include <limits>
#include <utility>

#include "diagnosis/thresholds.h"

namespace lacuna {

std::optional<size_t> RefittedRanking::FindUsable(const std::string& type) const {
  for (size_t k = 0; k < effects.size(); ++k)
    if (effects[k].scored.candidate.type == type && IsUsable(k)) return k;
  return std::nullopt;
}

void RefittedRanking::Take(size_t effect, VariantRefit fitted) {
  SetRefit(std::move(fitted.variant), fitted.refit, &effects[effect]);
  refits[effect] = std::move(fitted.refit);
}

bool RefittedRanking::TakeIfBetter(size_t effect, VariantRefit fitted, const NoiseLevel& noise) {
  if (IsUsable(effect) && !(EvidenceOf(fitted.variant, fitted.refit, noise) >
                            EvidenceOf(effects[effect].scored, refits[effect], noise)))
    return false;
  Take(effect, std::move(fitted));
  return true;
}

double DecisiveLead(double gain) {
  return std::max(kThresholds.refit.beaten_by, kThresholds.refit.beaten_share * gain);
}

double HopelessCost(const RefittedRanking& ranked, const std::optional<size_t>& effect,
                    const NoiseLevel& noise) {
  if (!effect || !ranked.IsUsable(*effect)) return std::numeric_limits<double>::infinity();
  const double cost = ranked.refits[*effect].calibration.cost;
  const double gain = (ranked.baseline.calibration.cost - cost) / noise.variance;
  return cost + noise.variance * DecisiveLead(gain);
}

double EvidenceBeyondBaseline(const RefittedRanking& ranked, const ScoredVariant& variant,
                              const EffectRefit& refit, const NoiseLevel& noise) {
  return EvidenceOf(variant, refit, noise) - ranked.baseline_evidence -
         SelectionPenalty(ranked.effects.size());
}

bool IsFarBehind(const RefittedRanking& ranked, const ScoredVariant& variant,
                 const EffectRefit& refit, const NoiseLevel& noise, double gain) {
  const double evidence = EvidenceBeyondBaseline(ranked, variant, refit, noise) + gain;
  return ranked.best && ranked.best->evidence - evidence > DecisiveLead(ranked.best->evidence);
}

void CompareWithBest(const NoiseLevel& noise, size_t effect, RefittedRanking* ranked) {
  RankedEffect& own = ranked->effects[effect];
  if (!own.HasUsableRefit()) return;
  const EffectRefit& refit = ranked->refits[effect];
  own.predicts = Predicts(refit, ranked->baseline, noise);
  const double evidence = EvidenceBeyondBaseline(*ranked, own.scored, refit, noise);
  if (!own.predicts || !(evidence > ranked->BestEvidence())) return;
  ranked->best = BestRefit{effect, evidence, std::max(0.0, evidence - own.scored.score.evidence)};
}

const RankedEffect* BestRefitted(const std::vector<RankedEffect>& effects) {
  const auto best = std::max_element(
      effects.begin(), effects.end(),
      [](const RankedEffect& a, const RankedEffect& b) { return a.evidence < b.evidence; });
  return best != effects.end() && best->evidence > 0 ? &*best : nullptr;
}

}  // namespace lacuna
