#include "diagnosis/verdict.h"

#include <algorithm>
#include <cmath>
#include <string>

namespace lacuna {
namespace {

const RankedEffect* FindEffect(const Diagnosis& diagnosis, const std::string& type) {
  for (const auto* effects : {&diagnosis.ranking, &diagnosis.alternatives.effects})
    for (const RankedEffect& effect : *effects)
      if (effect.scored.candidate.type == type) return &effect;
  return nullptr;
}

// The nuisance of this name with the most evidence; −1: there is none.
int FindNuisance(const Diagnosis& diagnosis, const std::string& name) {
  int best = -1;
  for (size_t k = 0; k < diagnosis.nuisances.size(); ++k) {
    if (diagnosis.nuisances[k].candidate.card.name != name) continue;
    if (best < 0 ||
        diagnosis.nuisances[k].evidence > diagnosis.nuisances[static_cast<size_t>(best)].evidence)
      best = static_cast<int>(k);
  }
  return best;
}

// The explained share of the squared misfit in excess of the noise. Both misfits are in σ.
double ExplainedExcess(double before, double after) {
  if (before <= 1) return 1;
  return std::clamp((before * before - after * after) / (before * before - 1), 0.0, 1.0);
}

// The first effect among these names; null: there are nuisances only.
const RankedEffect* FirstEffect(const Diagnosis& diagnosis, const std::vector<std::string>& names) {
  for (const std::string& name : names)
    if (const RankedEffect* effect = FindEffect(diagnosis, name)) return effect;
  return nullptr;
}

// The largest evidence that a single effect has after its refit, or the adequacy test gives one; at
// least 0.
double BestEvidence(const Diagnosis& diagnosis) {
  double best = std::max(0.0, diagnosis.decision.adequacy.further_evidence);
  for (const RankedEffect& effect : diagnosis.ranking)
    if (effect.HasUsableRefit()) best = std::max(best, effect.evidence);
  return best;
}

VerdictReason ErrorReduction(const Diagnosis& diagnosis, const RankedEffect& effect) {
  const bool adjusted =
      std::any_of(diagnosis.nuisances.begin(), diagnosis.nuisances.end(),
                  [](const ScoredNuisance& nuisance) { return nuisance.adopted; });
  return EffectReducesError{effect.scored.candidate.type,       effect.evidence,
                            diagnosis.errors.has_held_out,      adjusted,
                            diagnosis.errors.without_nuisances, effect.errors.without_nuisances};
}

void ExplainWithoutName(const Diagnosis& diagnosis, Conclusion* conclusion) {
  const ModelErrors& errors = diagnosis.errors;
  const auto nuisances = [&] {
    for (const std::string& name : conclusion->effects)
      if (const int k = FindNuisance(diagnosis, name); k >= 0)
        conclusion->reasons.emplace_back(
            NuisanceExplains{k, diagnosis.nuisances[static_cast<size_t>(k)].explained});
  };
  switch (conclusion->verdict) {
    case Verdict::kNoPower:
      conclusion->reasons = {NothingDetectable{}};
      break;
    case Verdict::kAdequate:
      conclusion->reasons = {ErrorIsNoise{errors.held_out_rms, errors.rms_over_sigma}};
      break;
    case Verdict::kNuisance:
      nuisances();
      break;
    default:
      break;
  }
}

// "Not in library": what is known of the part that an effect explains, and of the rest.
void ExplainUnknown(const Diagnosis& diagnosis, Conclusion* conclusion) {
  const RecordedAdequacy& adequacy = diagnosis.decision.adequacy;
  const RankedEffect* best = FirstEffect(diagnosis, conclusion->effects);
  // A member of a pair may have no evidence of its own.
  if (best == nullptr || !best->HasUsableRefit() || !(best->evidence > 0)) {
    conclusion->reasons = {ErrorUnexplained{
        diagnosis.errors.held_out_rms, diagnosis.errors.rms_over_sigma, BestEvidence(diagnosis)}};
    return;
  }
  const std::string& type = best->scored.candidate.type;
  // The test of adequacy may have examined the effect with nuisances beside it.
  const bool is_tested = std::count(adequacy.beside.begin(), adequacy.beside.end(), type) > 0;
  conclusion->reasons = {ResidualRemains{
      type, ExplainedExcess(diagnosis.baseline_rms_over_sigma, best->rms_over_sigma),
      is_tested ? adequacy.rms_over_sigma : best->rms_over_sigma}};
  if (const RankedEffect* other = FindEffect(diagnosis, adequacy.further);
      other != nullptr && adequacy.further_evidence > 0) {
    conclusion->reasons.emplace_back(
        EvidenceForAnother{type, best->evidence, adequacy.further, adequacy.further_evidence});
    conclusion->next_steps = {AddAndDiagnose{type, adequacy.further}};
  }
}

}  // namespace

void Conclude(const Decision& decision, Diagnosis* diagnosis) {
  diagnosis->decision = decision.record;
  Conclusion conclusion;
  conclusion.verdict = decision.verdict;
  conclusion.effects = decision.names;
  ExplainWithoutName(*diagnosis, &conclusion);
  if (decision.verdict == Verdict::kNotInLibrary) ExplainUnknown(*diagnosis, &conclusion);
  if (decision.verdict == Verdict::kMissing || decision.verdict == Verdict::kAmbiguous) {
    for (const std::string& name : decision.names)
      if (const RankedEffect* effect = FindEffect(*diagnosis, name);
          effect != nullptr && effect->HasUsableRefit() &&
          (conclusion.reasons.empty() || decision.verdict == Verdict::kMissing))
        conclusion.reasons.push_back(ErrorReduction(*diagnosis, *effect));
  }
  if (decision.verdict == Verdict::kAmbiguous) {
    if (const RankedEffect* best = FirstEffect(*diagnosis, decision.names))
      conclusion.next_steps.emplace_back(SeparateLookAlikes{best->scored.candidate.type});
    for (const std::string& name : decision.names)
      if (const int k = FindNuisance(*diagnosis, name); k >= 0)
        conclusion.next_steps.emplace_back(CheckNuisance{k});
  }
  static_cast<Conclusion&>(*diagnosis) = std::move(conclusion);
}

}  // namespace lacuna
