#include "diagnosis/verdict.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

constexpr AdequacyThresholds kAdequacy = kThresholds.adequacy;
constexpr NamingThresholds kNaming = kThresholds.naming;

using RankedEffects = std::vector<const RankedEffect*>;

const std::string& TypeOf(const RankedEffect& effect) { return effect.scored.candidate.type; }

// No effect, at the largest plausible size, would stand out from the noise.
bool IsNothingDetectable(const std::vector<RankedEffect>& ranking) {
  for (const RankedEffect& effect : ranking) {
    const std::vector<CandidateAmount> amounts = AmountsOf(effect.scored.candidate);
    for (size_t k = 0; k < amounts.size(); ++k)
      if (effect.scored.score.detectable[static_cast<Eigen::Index>(k)] < amounts[k].plausible)
        return false;
  }
  return true;
}

const RankedEffect* Find(const std::vector<RankedEffect>& ranking, const std::string& type) {
  for (const RankedEffect& effect : ranking)
    if (TypeOf(effect) == type) return &effect;
  return nullptr;
}

// The usable refits that satisfy `counts`, the one with the most evidence first.
RankedEffects ByEvidence(const std::vector<RankedEffect>& effects,
                         const std::function<bool(const RankedEffect& effect)>& counts) {
  RankedEffects chosen;
  for (const RankedEffect& effect : effects)
    if (effect.HasUsableRefit() && counts(effect)) chosen.push_back(&effect);
  std::stable_sort(chosen.begin(), chosen.end(),
                   [](const auto* a, const auto* b) { return a->evidence > b->evidence; });
  return chosen;
}

// Its refitted size is compatible with 0, and its evidence is not beyond such intervals.
bool MayBeNothing(const RankedEffect& effect) {
  return !effect.sizes.empty() && effect.evidence < kNaming.evidence_beyond_intervals &&
         std::all_of(effect.sizes.begin(), effect.sizes.end(),
                     [](const ParameterEstimate& size) { return size.low <= 0 && size.high >= 0; });
}

// The explained share of the squared misfit in excess of the noise. Both misfits are in σ.
double ExplainedExcess(double before, double after) {
  if (before <= 1) return 1;
  return std::clamp((before * before - after * after) / (before * before - 1), 0.0, 1.0);
}

// Whether the model with its nuisances, as estimated from the fitted frames, predicts the held-out
// ones. The residual over all frames cannot answer this: with mesh, dimensions and drift at their
// best for all frames, these compensate for a missing effect. Nuisances of single frames predict
// nothing about other frames, so the question does not arise where they explain most.
bool PredictsHeldOutFrames(const Diagnosis& diagnosis) {
  const ScoredNuisance* best = nullptr;
  for (const ScoredNuisance& nuisance : diagnosis.nuisances)
    if (!nuisance.candidate.card.is_always_in_model &&
        (nuisance.adopted || nuisance.evidence > kNaming.least_evidence) &&
        (best == nullptr || nuisance.evidence > best->evidence))
      best = &nuisance;
  return !diagnosis.errors.has_held_out ||
         diagnosis.errors.without_nuisances <= kAdequacy.held_out_noise ||
         (best != nullptr && best->candidate.card.acts_on_single_frames);
}

// The largest evidence that an uncertain discretisation could account for, and the nuisance that it
// is; −1: none is uncertain.
struct DiscretisationBound {
  double evidence = 0;
  int nuisance = -1;
};

DiscretisationBound LargestDiscretisationUncertainty(const std::vector<ScoredNuisance>& nuisances) {
  DiscretisationBound bound;
  for (size_t k = 0; k < nuisances.size(); ++k) {
    const double evidence = DiscretisationUncertainty(nuisances[k].uncertain_evidence);
    if (evidence <= bound.evidence) continue;
    bound.evidence = evidence;
    if (nuisances[k].uncertain_evidence > 0) bound.nuisance = static_cast<int>(k);
  }
  return bound;
}

// The least evidence with which an effect is named.
double EvidenceNeeded(const Diagnosis& diagnosis) {
  double of_nuisances = 0;
  for (const ScoredNuisance& nuisance : diagnosis.nuisances) {
    // Mesh, step and dimensions are simulated and have bounded priors: no linearisation omits
    // anything.
    if (nuisance.adopted && !nuisance.candidate.card.is_always_in_model)
      of_nuisances += std::max(0.0, nuisance.evidence);
  }
  return std::max(
      {kNaming.least_evidence, diagnosis.control, kNaming.linearisation_share * of_nuisances});
}

// The lead in evidence with which an effect is preferred to a rival.
double LeadNeeded(const Diagnosis& diagnosis, double evidence) {
  double uncertain_evidence = 0;
  for (const ScoredNuisance& nuisance : diagnosis.nuisances)
    uncertain_evidence += nuisance.uncertain_evidence;
  return std::max(std::clamp(kNaming.lead_share * evidence, kNaming.least_lead, kNaming.most_lead),
                  kNaming.discretisation_factor * uncertain_evidence);
}

// Whether a nuisance explains enough to be a cause of the misfit.
bool IsCause(const ScoredNuisance& nuisance, bool at_noise) {
  const bool has_evidence = nuisance.evidence > kNaming.least_evidence;
  if (nuisance.candidate.card.is_always_in_model)
    return has_evidence && !at_noise && nuisance.explained > kAdequacy.discretisation_share;
  return nuisance.adopted || has_evidence;
}

// The nuisances that explain a part of the misfit.
struct NuisanceCauses {
  std::vector<std::string> names;
  std::vector<VerdictReason> explaining, negligible;
  double most_explained = 0;
};

NuisanceCauses FindNuisanceCauses(const Diagnosis& diagnosis) {
  const bool at_noise = diagnosis.errors.rms_over_sigma <= kAdequacy.noise;
  NuisanceCauses causes;
  for (size_t k = 0; k < diagnosis.nuisances.size(); ++k) {
    const ScoredNuisance& nuisance = diagnosis.nuisances[k];
    if (!IsCause(nuisance, at_noise)) continue;
    const int index = static_cast<int>(k);
    if (at_noise && nuisance.explained < kAdequacy.negligible_share) {
      causes.negligible.emplace_back(NuisanceIsNegligible{index, kAdequacy.negligible_share});
      continue;
    }
    causes.most_explained = std::max(causes.most_explained, nuisance.explained);
    causes.names.push_back(nuisance.candidate.card.name);
    causes.explaining.emplace_back(NuisanceExplains{index, nuisance.explained});
  }
  return causes;
}

// No effect is needed, or none helps. `uncertain`: the nuisance that could account for the best
// effect's evidence; −1: that is insufficient by itself.
Conclusion ConcludeWithoutEffect(const Diagnosis& diagnosis, double best_evidence, bool is_noise,
                                 int uncertain) {
  Conclusion conclusion;
  NuisanceCauses causes = FindNuisanceCauses(diagnosis);
  if (!causes.names.empty() && (is_noise || (causes.most_explained > kAdequacy.nuisance_share &&
                                             PredictsHeldOutFrames(diagnosis)))) {
    conclusion.verdict = Verdict::kNuisance;
    conclusion.effects = std::move(causes.names);
    conclusion.reasons = std::move(causes.explaining);
    return conclusion;
  }
  const ModelErrors& errors = diagnosis.errors;
  if (is_noise) {
    conclusion.verdict = Verdict::kAdequate;
    conclusion.reasons = {ErrorIsNoise{errors.held_out_rms, errors.rms_over_sigma}};
  } else {
    conclusion.verdict = Verdict::kNotInLibrary;
    conclusion.reasons = {
        ErrorUnexplained{errors.held_out_rms, errors.rms_over_sigma, best_evidence}};
  }
  if (uncertain >= 0) {
    const double uncertain_evidence =
        diagnosis.nuisances[static_cast<size_t>(uncertain)].uncertain_evidence;
    conclusion.reasons.emplace_back(UncertainDiscretisation{
        uncertain, best_evidence, DiscretisationUncertainty(uncertain_evidence)});
    conclusion.next_steps = {RefineDiscretisation{uncertain, /*fit_again=*/false}};
  }
  const std::vector<VerdictReason>& further = is_noise ? causes.negligible : causes.explaining;
  conclusion.reasons.insert(conclusion.reasons.end(), further.begin(), further.end());
  return conclusion;
}

// "Not in library" where the best effect, or it and all rivals within the lead, explain only a part
// of the misfit. `chance`: the evidence that they may leave for another effect. Nothing: they
// explain enough.
std::optional<Conclusion> RejectPartialExplanations(const Diagnosis& diagnosis,
                                                    const RankedEffect& best,
                                                    const RankedEffects& close, double chance) {
  const double before = diagnosis.errors.without_nuisances;
  const auto predicts_poorly = [&](const RankedEffect* effect) {
    const double after = effect->errors.without_nuisances;
    return diagnosis.errors.has_held_out && after > kAdequacy.held_out_noise &&
           ExplainedExcess(before, after) < kNaming.explained_share;
  };
  const auto leaves_evidence = [&](const RankedEffect* effect) {
    return effect->further.evidence >
           std::max(chance, effect->further.nuisance_evidence + kNaming.least_lead);
  };
  const std::string& type = TypeOf(best);
  const double excess = ExplainedExcess(diagnosis.baseline_rms_over_sigma, best.rms_over_sigma);
  Conclusion conclusion;
  conclusion.verdict = Verdict::kNotInLibrary;
  if (best.rms_over_sigma > kAdequacy.noise && excess < kNaming.explained_share) {
    conclusion.reasons = {ResidualRemains{type, excess, best.rms_over_sigma}};
  } else if (std::all_of(close.begin(), close.end(), predicts_poorly)) {
    conclusion.reasons = {
        HeldOutErrorRemains{type, best.evidence, before, best.errors.without_nuisances}};
  } else if (std::all_of(close.begin(), close.end(), leaves_evidence)) {
    conclusion.reasons = {
        EvidenceForAnother{type, best.evidence, best.further.type, best.further.evidence}};
    conclusion.next_steps = {AddAndDiagnose{type, best.further.type}};
  } else {
    return std::nullopt;
  }
  return conclusion;
}

// Why an effect cannot be ruled out although its evidence is not within the lead; nothing: it can.
std::optional<VerdictReason> ReasonToKeep(const RankedEffect& rival, const RankedEffect& best,
                                          double lead, double control) {
  const double error = rival.errors.unfitted_rms_over_sigma;
  const double of_best = best.errors.unfitted_rms_over_sigma;
  if (rival.evidence > std::max(kNaming.least_evidence, control) &&
      error < of_best - kNaming.better_prediction)
    return RivalPredictsBetter{TypeOf(rival), rival.evidence, error, of_best};
  // An effect of size zero has the evidence 0. A refit that ends below has found another minimum,
  // and cannot rule out what first order puts beside the best.
  const double first_order = rival.scored.score.evidence;
  if (rival.evidence < 0 && first_order >= best.scored.score.evidence - lead)
    return RivalNotFitted{TypeOf(rival), first_order};
  return std::nullopt;
}

void AddRivalEffects(const Diagnosis& diagnosis, const RankedEffect& best, double lead,
                     Conclusion* conclusion) {
  // Effects against which the held-out frames alone speak are rivals, too: evidence counts these
  // frames already.
  for (const RankedEffect* rival : ByEvidence(
           diagnosis.ranking, [&](const RankedEffect& effect) { return &effect != &best; })) {
    const bool is_close = rival->evidence > best.evidence - lead;
    const auto reason =
        is_close ? std::nullopt : ReasonToKeep(*rival, best, lead, diagnosis.control);
    if (is_close || reason) conclusion->effects.push_back(TypeOf(*rival));
    if (reason) conclusion->reasons.push_back(*reason);
  }
  // Look-alikes that were not refitted cannot be ruled out.
  for (const std::string& other : best.scored.look_alikes) {
    const RankedEffect* rival = Find(diagnosis.ranking, other);
    if (rival != nullptr && !rival->refitted) conclusion->effects.push_back(other);
  }
}

// Returns what would settle the question: refinements, or else checks of the rival nuisances.
std::vector<SuggestedStep> AddRivalNuisances(const Diagnosis& diagnosis, const RankedEffect& best,
                                             double lead, Conclusion* conclusion) {
  std::vector<SuggestedStep> refinements, checks;
  for (size_t k = 0; k < diagnosis.nuisances.size(); ++k) {
    const ScoredNuisance& nuisance = diagnosis.nuisances[k];
    const int index = static_cast<int>(k);
    const double part = nuisance.candidate.card.outgrows_first_order ? kNaming.grip_share : 1;
    const double evidence = nuisance.refitted.value_or(nuisance.evidence);
    if (DiscretisationUncertainty(nuisance.uncertain_evidence) > best.evidence) {
      conclusion->effects.push_back(nuisance.candidate.card.name);
      refinements.emplace_back(RefineDiscretisation{index, /*fit_again=*/true});
    } else if (!nuisance.adopted &&
               evidence > std::min(best.evidence - lead, part * best.evidence)) {
      conclusion->effects.push_back(nuisance.candidate.card.name);
      checks.emplace_back(CheckNuisance{index});
      if (evidence > best.evidence)
        conclusion->reasons.emplace_back(NuisanceHasMoreEvidence{index, evidence});
    }
  }
  if (!refinements.empty()) return refinements;
  checks.insert(checks.begin(), SeparateLookAlikes{TypeOf(best)});
  return checks;
}

// The best effect, alone or with the rivals that cannot be ruled out.
Conclusion NameEffects(const Diagnosis& diagnosis, const RankedEffect& best, double lead) {
  const bool adjusted =
      std::any_of(diagnosis.nuisances.begin(), diagnosis.nuisances.end(),
                  [](const ScoredNuisance& nuisance) { return nuisance.adopted; });
  const ModelErrors& errors = diagnosis.errors;
  Conclusion conclusion;
  conclusion.effects = {TypeOf(best)};
  conclusion.reasons = {EffectReducesError{TypeOf(best), best.evidence, errors.has_held_out,
                                           adjusted, errors.without_nuisances,
                                           best.errors.without_nuisances}};
  AddRivalEffects(diagnosis, best, lead, &conclusion);
  std::vector<SuggestedStep> next_steps = AddRivalNuisances(diagnosis, best, lead, &conclusion);
  if (adjusted && errors.has_held_out && best.errors.held_out_rms > errors.held_out_rms)
    conclusion.reasons.emplace_back(
        UnadjustedErrorRises{errors.held_out_rms, best.errors.held_out_rms});
  conclusion.verdict = conclusion.effects.size() == 1 ? Verdict::kMissing : Verdict::kAmbiguous;
  if (conclusion.verdict == Verdict::kAmbiguous) conclusion.next_steps = std::move(next_steps);
  return conclusion;
}

Conclusion Conclude(const Diagnosis& diagnosis) {
  if (IsNothingDetectable(diagnosis.ranking))
    return {Verdict::kNoPower, {}, {NothingDetectable{}}, {}};
  const bool is_noise =
      diagnosis.best_rms_over_sigma <= kAdequacy.noise && PredictsHeldOutFrames(diagnosis);
  const bool at_noise = diagnosis.baseline_rms_over_sigma <= kAdequacy.noise;
  const RankedEffects refitted = ByEvidence(diagnosis.ranking, [&](const RankedEffect& effect) {
    return effect.held_out_evidence > -kNaming.held_out_loss && !(at_noise && MayBeNothing(effect));
  });
  const double evidence = refitted.empty() ? 0 : refitted.front()->evidence;
  const DiscretisationBound bound = LargestDiscretisationUncertainty(diagnosis.nuisances);
  if (evidence < EvidenceNeeded(diagnosis))
    return ConcludeWithoutEffect(diagnosis, evidence, is_noise, /*uncertain=*/-1);
  // Where the model without the effect is at the noise already, what the discretisation could
  // account for is no evidence.
  if (at_noise && evidence < bound.evidence)
    return ConcludeWithoutEffect(diagnosis, evidence, is_noise, bound.nuisance);
  const RankedEffect& best = *refitted.front();
  const double lead = LeadNeeded(diagnosis, evidence);
  const RankedEffects close = ByEvidence(diagnosis.ranking, [&](const RankedEffect& effect) {
    return effect.evidence > evidence - lead;
  });
  const double chance = std::max({kNaming.least_evidence, diagnosis.control, bound.evidence,
                                  kNaming.remainder_share * evidence});
  if (auto rejected = RejectPartialExplanations(diagnosis, best, close, chance))
    return *std::move(rejected);
  return NameEffects(diagnosis, best, lead);
}

}  // namespace

double DiscretisationUncertainty(double uncertain_evidence) {
  return kNaming.discretisation_factor * uncertain_evidence + kNaming.least_lead;
}

void Decide(Diagnosis* diagnosis) { static_cast<Conclusion&>(*diagnosis) = Conclude(*diagnosis); }

void DecideAgainstNuisances(Diagnosis* diagnosis) {
  const NuisanceAlternatives& alternatives = diagnosis->alternatives;
  const double before = alternatives.bare.without_nuisances;
  const RankedEffects rivals = ByEvidence(alternatives.effects, [&](const RankedEffect& effect) {
    return effect.evidence > std::max(diagnosis->control, kNaming.alternative_share *
                                                              alternatives.nuisances_evidence) &&
           effect.errors.without_nuisances < kNaming.alternative_error * before;
  });
  if (rivals.empty()) return;
  const RankedEffect& best = *rivals.front();
  Conclusion conclusion;
  conclusion.verdict = Verdict::kAmbiguous;
  for (const RankedEffect* rival : rivals) conclusion.effects.push_back(TypeOf(*rival));
  // Look-alikes that were not tried cannot be ruled out.
  for (const std::string& other : best.scored.look_alikes)
    if (Find(alternatives.effects, other) == nullptr) conclusion.effects.push_back(other);
  conclusion.effects.insert(conclusion.effects.end(), diagnosis->effects.begin(),
                            diagnosis->effects.end());
  conclusion.reasons = {EffectReplacesNuisances{
      TypeOf(best), best.evidence, alternatives.nuisances_evidence, diagnosis->effects,
      diagnosis->errors.has_held_out, before, best.errors.without_nuisances}};
  conclusion.next_steps = {SeparateLookAlikes{TypeOf(best)}};
  for (size_t k = 0; k < diagnosis->nuisances.size(); ++k) {
    const ScoredNuisance& nuisance = diagnosis->nuisances[k];
    if (nuisance.adopted && !nuisance.candidate.card.is_always_in_model)
      conclusion.next_steps.emplace_back(CheckNuisance{static_cast<int>(k)});
  }
  static_cast<Conclusion&>(*diagnosis) = std::move(conclusion);
}

}  // namespace lacuna
