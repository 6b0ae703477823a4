#include "diagnosis/recorded_diagnosis.h"

#include "effects/catalogue.h"

namespace lacuna {
namespace {

RecordedInterval IntervalOf(const ParameterEstimate& estimate) {
  return {estimate.value, estimate.low, estimate.high};
}

std::vector<RecordedSize> SizesOf(const RankedEffect& effect) {
  const Score& score = effect.scored.score;
  const std::vector<CandidateAmount> amounts = AmountsOf(effect.scored.candidate);
  std::vector<RecordedSize> sizes;
  for (size_t k = 0; k < effect.scored.parameters.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    sizes.push_back({effect.scored.parameters[k], effect.scored.units[k], score.size[at],
                     score.deviation[at], score.detectable[at], std::nullopt});
    if (!effect.scored.candidate.IsPilot()) sizes.back().plausible = amounts.at(k).plausible;
    if (k >= effect.sizes.size()) continue;
    sizes.back().refitted = IntervalOf(effect.sizes[k]);
    sizes.back().at_limit = k < effect.at_limit.size() && effect.at_limit[k];
  }
  return sizes;
}

RecordedRefit RefitOf(const RankedEffect& effect) {
  RecordedRefit refit;
  refit.message = effect.refit_message;
  refit.unconverged = effect.unconverged;
  refit.evidence = effect.evidence;
  refit.held_out_evidence = effect.held_out_evidence;
  refit.fails_at_limit = effect.fails_at_limit;
  refit.explained = effect.explained;
  refit.removed = effect.removed;
  refit.rms_over_sigma = effect.rms_over_sigma;
  refit.errors = effect.errors;
  for (const NamedEstimate& other : effect.others)
    refit.others.push_back({other.name, other.unit, IntervalOf(other.estimate)});
  return refit;
}

RecordedEffect EffectOf(const RankedEffect& effect) {
  const CandidateEffect& candidate = effect.scored.candidate;
  const CatalogueEntry* entry = FindEntry(candidate.type);
  RecordedEffect recorded;
  recorded.type = candidate.type;
  recorded.title = entry != nullptr ? entry->card->title : candidate.type;
  recorded.variant = candidate.variant;
  if (candidate.effect != nullptr)
    recorded.separating_experiment = candidate.effect->Card().separating_experiment;
  recorded.look_alikes = effect.scored.look_alikes;
  const Score& score = effect.scored.score;
  recorded.first_order = {score.evidence, score.explained, score.absorbed,
                          score.held_out_rms_over_sigma};
  recorded.sizes = SizesOf(effect);
  if (effect.refitted) recorded.refit = RefitOf(effect);
  return recorded;
}

}  // namespace

DiagnosisRecord RecordOf(const Diagnosis& diagnosis) {
  DiagnosisRecord record;
  static_cast<Conclusion&>(record) = diagnosis;
  record.noise = {diagnosis.noise, diagnosis.scan_noise, diagnosis.noise_level.correlation_time,
                  diagnosis.noise_level.variance};
  record.time_step = diagnosis.time_step;
  record.decision = diagnosis.decision;
  record.agreement = diagnosis.agreement;
  record.baseline_rms_over_sigma = diagnosis.baseline_rms_over_sigma;
  record.best_rms_over_sigma = diagnosis.best_rms_over_sigma;
  record.errors = diagnosis.errors;
  for (const ScoredNuisance& nuisance : diagnosis.nuisances)
    record.nuisances.push_back({nuisance.candidate.card.name, nuisance.candidate.what,
                                nuisance.candidate.card.advice, nuisance.evidence,
                                nuisance.explained, nuisance.refitted, nuisance.adopted,
                                nuisance.uncertain_evidence});
  for (const RankedEffect& effect : diagnosis.ranking) record.ranking.push_back(EffectOf(effect));
  record.untried = diagnosis.untried;
  for (const RankedEffect& effect : diagnosis.alternatives.effects)
    record.alternatives.effects.push_back(EffectOf(effect));
  record.alternatives.nuisances_evidence = diagnosis.alternatives.nuisances_evidence;
  record.alternatives.rms_over_sigma_without_both = diagnosis.alternatives.bare.without_nuisances;
  return record;
}

}  // namespace lacuna
