#include "diagnosis/variant_refit.h"

#include <utility>

#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// Whether a refit has probably ended in a local minimum.
bool IsLikelyLocalMinimum(const EffectRanking& ranking, const EffectRefit& refit,
                          const EffectRefit& without, const Score& score) {
  if (!refit.message.empty() || PredictsWorse(refit.errors, without.errors)) return true;
  // Where nothing was to be gained, nothing is missed.
  if (score.evidence < kThresholds.refit.least_evidence) return false;
  const double noise = ranking.noise.variance * static_cast<double>(ObservedRows(ranking.misfit));
  return FallsShort(EvidenceOf(without.hypothesis, ranking.noise),
                    EvidenceOf(refit.hypothesis, ranking.noise), noise, score.evidence);
}

// Whether the fit was given up because it would not come down to `hopeless_cost`.
bool IsEndedAsHopeless(const EffectRefit& refit, double hopeless_cost) {
  const Calibration& fit = refit.calibration;
  return refit.message.empty() && !fit.usable && fit.cost > hopeless_cost;
}

}  // namespace

double EvidenceOf(const ScoredVariant& variant, const EffectRefit& refit, const NoiseLevel& noise) {
  if (!refit.message.empty()) return -std::numeric_limits<double>::infinity();
  return EvidenceOf(refit.hypothesis, noise).log_evidence - variant.selection_penalty;
}

VariantRefit RefitEffect(const RefitContext& context, const AdoptedNuisances& adopted,
                         const EffectRefit& without, bool is_found, const ScoredEffect& effect,
                         const RivalRefit& rival) {
  const RefitThresholds& thresholds = kThresholds.refit;
  const NoiseLevel& noise = context.ranking.noise;
  const bool is_far_off = !is_found && RmsOverSigma(without.hypothesis) > kFarFromTruth;
  int predictions = 0;
  bool starts_again = true;
  const auto may_start = [&] { return starts_again && predictions < thresholds.most_of_effect; };
  const RefitSetting setting{context.model, adopted};
  const auto from = [&](const ScoredVariant& variant, RefitFrom start) {
    VariantRefit fitted{variant, Refit(setting, &variant,
                                       {.is_far_off = is_far_off,
                                        .from = start,
                                        .without = &without,
                                        .hopeless_cost = rival.hopeless_cost})};
    predictions += fitted.refit.calibration.predictions;
    return fitted;
  };
  VariantRefit best = from(effect, RefitFrom::kFirstOrder);
  starts_again = !(rival.is_far_ahead && IsEndedAsHopeless(best.refit, rival.hopeless_cost));
  const auto keep_better = [&](VariantRefit other) {
    if (EvidenceOf(other.variant, other.refit, noise) > EvidenceOf(best.variant, best.refit, noise))
      best = std::move(other);
  };
  for (const ScoredVariant& elsewhere : effect.elsewhere) {
    if (elsewhere.score.evidence < thresholds.variant_share * effect.score.evidence) break;
    if (!may_start()) break;
    keep_better(from(elsewhere, RefitFrom::kFirstOrder));
  }
  if (!effect.candidate.IsPilot() && may_start() &&
      IsLikelyLocalMinimum(context.ranking, best.refit, without, effect.score))
    keep_better(from(effect, RefitFrom::kFixedSize));
  const int of_others = predictions - best.refit.calibration.predictions;
  best.refit = ContinueWithinBudget(setting, &best.variant, std::move(best.refit),
                                    rival.hopeless_cost, of_others);
  return best;
}

void SetRefit(ScoredVariant variant, const EffectRefit& refit, RankedEffect* effect) {
  RankedEffect changed;
  changed.scored = std::move(effect->scored);
  static_cast<ScoredVariant&>(changed.scored) = std::move(variant);
  changed.refitted = true;
  changed.refit_message = refit.message;
  changed.unconverged = refit.unconverged;
  changed.errors = refit.errors;
  if (refit.message.empty()) {
    changed.values = refit.effect_values;
    changed.baseline_values = refit.baseline_values;
    changed.sizes = refit.sizes;
    changed.at_limit = refit.at_limit;
    changed.others = refit.others;
  }
  *effect = std::move(changed);
}

}  // namespace lacuna
