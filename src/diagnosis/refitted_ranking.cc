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

double HopelessCost(const RefittedRanking& ranked, const std::optional<size_t>& effect) {
  if (!effect || !ranked.IsUsable(*effect)) return std::numeric_limits<double>::infinity();
  const double cost = ranked.refits[*effect].calibration.cost;
  return cost + DecisiveLead(ranked.baseline.calibration.cost - cost);
}

bool IsFarBehind(const RefittedRanking& ranked, const EffectRefit& refit, const NoiseLevel& noise,
                 double gain) {
  const double evidence = EvidenceOf(refit, noise).all - ranked.baseline_evidence + gain;
  return ranked.best && ranked.best->evidence - evidence > DecisiveLead(ranked.best->evidence);
}

void CompareWithBest(const NoiseLevel& noise, size_t effect, RefittedRanking* ranked) {
  RankedEffect& own = ranked->effects[effect];
  if (!own.HasUsableRefit()) return;
  const EffectRefit& refit = ranked->refits[effect];
  own.predicts = Predicts(refit, ranked->baseline, noise);
  const double evidence = EvidenceOf(refit, noise).all - ranked->baseline_evidence;
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
