#include "diagnosis/refits.h"

#include <glog/logging.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "diagnosis/removed_misfit.h"
#include "diagnosis/scored_beside.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// The model with which effects are refitted, and the nuisances beside it: those along the motion of
// a refit where there are such columns.
BaselineModel ModelOf(const RefitContext& context, const RefittedRanking& ranked,
                      Progress* progress) {
  BaselineModel model = context.model;
  model.progress = progress;
  if (!ranked.along) return model;
  model.noise = ranked.along->noise;
  model.model_error = ranked.along->ModelError();
  return model;
}
const AdoptedNuisances& NuisancesOf(const RefitContext& context, const RefittedRanking& ranked) {
  return ranked.along ? ranked.along->adopted : context.ranking.adopted;
}

// The model without an effect, beside these nuisances.
EffectRefit RefitWithout(const BaselineModel& model, const AdoptedNuisances& nuisances) {
  return ContinueWithinBudget(model, nullptr, nuisances, Refit(model, nullptr, nuisances, false));
}

// The model with an effect from these values, beside the present columns.
EffectRefit RefitBeside(const RefitContext& context, const RefittedRanking& ranked,
                        const ScoredVariant& variant, const Eigen::VectorXd& values,
                        double hopeless_cost, Progress* progress) {
  const BaselineModel model = ModelOf(context, ranked, progress);
  const AdoptedNuisances& nuisances = NuisancesOf(context, ranked);
  return ContinueWithinBudget(model, &variant, nuisances,
                              RefitFromValues(model, &variant, nuisances, values, hopeless_cost),
                              hopeless_cost);
}

// The cost of the fitted frames above which a refit is negligible beside that of `best`.
double HopelessCost(const RefittedRanking& ranked, const std::optional<size_t>& best) {
  if (!best || !ranked.IsUsable(*best)) return std::numeric_limits<double>::infinity();
  const double cost = ranked.refits[*best].calibration.cost;
  return cost + DecisiveLead(ranked.baseline.calibration.cost - cost);
}

// Whether a refit is so far behind the best one that it is negligible.
bool IsFarBehind(const RefittedRanking& ranked, const EffectRefit& refit, const NoiseLevel& noise) {
  const double evidence = EvidenceOf(refit, noise).all - ranked.baseline_evidence;
  return ranked.best && ranked.best_evidence - evidence > DecisiveLead(ranked.best_evidence);
}

// Sets whether the held-out frames refute the refit of an effect, and takes it for the best one
// where they do not and it has more evidence than the best one so far.
void CompareWithBest(const NoiseLevel& noise, size_t effect, RefittedRanking* ranked) {
  RankedEffect& own = ranked->effects[effect];
  if (!own.HasUsableRefit()) return;
  const EffectRefit& refit = ranked->refits[effect];
  own.predicts = Predicts(refit, ranked->baseline, noise);
  const double evidence = EvidenceOf(refit, noise).all - ranked->baseline_evidence;
  if (!own.predicts || !(evidence > ranked->best_evidence)) return;
  ranked->best = effect;
  ranked->best_evidence = evidence;
  ranked->underrated = std::max(0.0, evidence - own.scored.score.evidence);
}

// Refits an effect from the variants of `from`, and keeps the better refit where it has one
// already. Does nothing if it has none and no further effect may be refitted.
void RefitOne(const RefitContext& context, size_t effect, const ScoredEffect& from,
              RefittedRanking* ranked) {
  const RankedEffect& own = ranked->effects[effect];
  if (!own.refitted) {
    if (ranked->count == ranked->limit) return;
    ++ranked->count;
  }
  const bool is_found = ranked->best && RmsOverSigma(ranked->refits[*ranked->best].hypothesis) <=
                                            kThresholds.refit.converged_rms;
  const BaselineModel model = ModelOf(context, *ranked, context.model.progress);
  VariantRefit fitted =
      RefitEffect({model, context.ranking}, NuisancesOf(context, *ranked), ranked->baseline,
                  is_found, from, HopelessCost(*ranked, ranked->best));
  // The score stays that of all fitted frames.
  if (&from != &own.scored) fitted.variant.score = own.scored.score;
  if (ranked->TakeIfBetter(effect, std::move(fitted), context.ranking.noise))
    CompareWithBest(context.ranking.noise, effect, ranked);
}

bool AreOfOneFamily(const RankedEffect& a, const RankedEffect& b) {
  const auto &one = a.scored.candidate.effect, &other = b.scored.candidate.effect;
  return one != nullptr && other != nullptr && one->Card().family == other->Card().family &&
         one->Card().family != EffectFamily::kOther;
}

bool IsBeaten(const RefittedRanking& ranked, size_t effect) {
  // A derivative may give no evidence for a member of the best effect's family that is missing; a
  // pilot has been simulated at a finite size.
  if (ranked.best && AreOfOneFamily(ranked.effects[effect], ranked.effects[*ranked.best]) &&
      !ranked.effects[effect].scored.candidate.IsPilot())
    return false;
  // First order may underrate a rival as much as it has underrated the best effect.
  const double lead =
      ranked.best_evidence - ranked.underrated - ranked.effects[effect].scored.score.evidence;
  return lead > DecisiveLead(ranked.best_evidence);
}

// What a refit with an effect is compared with.
struct Comparison {
  const CalibrationProblem& problem;
  const EffectRefit& without;  // the effect, beside the same nuisances
  NoiseLevel noise;
  size_t rivals;  // number of effects from which the effect was selected
  RefitEvidence before = EvidenceOf(without, noise);
};

// Sets what the comparison says about the refit of an effect.
void SetEvidence(const EffectRefit& with, const Comparison& comparison, RankedEffect* effect) {
  const RefitEvidence& before = comparison.before;
  const RefitEvidence after = EvidenceOf(with, comparison.noise);
  effect->predicts = Predicts(with, comparison.without, comparison.noise);
  effect->removed.reset();
  effect->evidence = after.all - before.all - SelectionPenalty(comparison.rivals) -
                     effect->scored.selection_penalty;
  effect->held_out_evidence = after.held_out - before.held_out;
  if (!std::isfinite(effect->evidence)) {
    effect->evidence = 0;
    effect->refit_message = "the evidence at the end of the refit is not a finite number";
    return;
  }
  effect->explained = std::clamp(1 - after.misfit / before.misfit, 0.0, 1.0);
  effect->removed = RemovedMisfit(comparison.without.hypothesis, with.hypothesis, comparison.noise,
                                  comparison.problem);
  effect->rms_over_sigma = RmsOverSigma(with.hypothesis);
}

// Fits the model with a refitted effect from where it is, beside the present columns. If that
// fails, the refit is settled beside them, and so is one `was_far_behind` that still is.
void Continue(const RefitContext& context, size_t effect, bool was_far_behind, double hopeless_cost,
              Progress* progress, RefittedRanking* ranked) {
  const ScoredVariant& variant = ranked->effects[effect].scored;
  const EffectRefit& before = ranked->refits[effect];
  const auto settled = [&](const std::string& reason) {
    EffectRefit refit = SettledBeside(ModelOf(context, *ranked, progress), variant,
                                      NuisancesOf(context, *ranked), before);
    if (refit.unconverged.empty()) refit.unconverged = reason;
    return refit;
  };
  if (was_far_behind) {
    EffectRefit refit =
        settled("it is too far behind to be fitted along the motion with " + ranked->along_type);
    if (refit.message.empty() && IsFarBehind(*ranked, refit, context.ranking.noise)) {
      ranked->Take(effect, {variant, std::move(refit)});
      return;
    }
  }
  EffectRefit refit =
      RefitBeside(context, *ranked, variant, before.values_at_fit, hopeless_cost, progress);
  if (!refit.message.empty())
    refit = settled("the fit along the motion with " + ranked->along_type +
                    " has failed: " + refit.message);
  ranked->Take(effect, {variant, std::move(refit)});
}

// The hypothesis with the smallest residual: the model without an effect, or a refit or a pair that
// the held-out frames do not refute.
const FittedHypothesis& LeastResidual(const RefittedRanking& ranked, const NoiseLevel& noise) {
  const FittedHypothesis* best = &ranked.baseline.hypothesis;
  double least = EvidenceOf(*best, noise).misfit;
  const auto compare = [&](const FittedHypothesis& hypothesis) {
    const double misfit = EvidenceOf(hypothesis, noise).misfit;
    if (misfit >= least) return;
    least = misfit;
    best = &hypothesis;
  };
  for (size_t k = 0; k < ranked.refits.size(); ++k)
    if (ranked.IsUsable(k) && Predicts(ranked.refits[k], ranked.baseline, noise))
      compare(ranked.refits[k].hypothesis);
  for (const FittedPair& pair : ranked.pairs)
    if (PairPredicts(pair, ranked, noise)) compare(pair.both.hypothesis);
  return *best;
}

// The effect with the most evidence after its refit; null: none has evidence.
const RankedEffect* BestRefitted(const std::vector<RankedEffect>& effects) {
  const auto best = std::max_element(
      effects.begin(), effects.end(),
      [](const RankedEffect& a, const RankedEffect& b) { return a.evidence < b.evidence; });
  return best != effects.end() && best->evidence > 0 ? &*best : nullptr;
}

// The effects as first order scores them beside the refitted baseline. The first scores count from
// the fit as it was, which the nuisances of every model may improve by more than any effect does. A
// fit that is far from the measurements is left as it is: there, the columns of these nuisances are
// differences of motions out of phase, which explain much and mean little. `base_has_adopted`: the
// baseline contains the nuisances that the ranking has adopted.
std::vector<ScoredEffect> ScoredBesideRefit(const RefitContext& context,
                                            const EffectRefit& baseline,
                                            std::vector<ScoredEffect> effects,
                                            bool base_has_adopted) {
  const LinearisedMisfit& misfit = context.ranking.misfit;
  if (RmsOverSigma(misfit.residual, misfit) > kFarFromTruth) return effects;
  const FittedHypothesis& at = baseline.hypothesis;
  return ScoredBeside(SpaceBeside(at.misfit, at.misfit.jacobian, at.priors, context.ranking, {},
                                  context.ranking.noise, base_has_adopted),
                      std::move(effects));
}

}  // namespace

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

bool PairPredicts(const FittedPair& pair, const RefittedRanking& ranked, const NoiseLevel& noise) {
  constexpr int kTests = 3;
  const auto beyond = [&](const std::string& type) {
    const std::optional<size_t> alone = ranked.FindUsable(type);
    return !alone || Predicts(pair.both, ranked.refits[*alone], noise, kTests);
  };
  return Predicts(pair.both, ranked.baseline, noise, kTests) && beyond(pair.first) &&
         beyond(pair.second.scored.candidate.type);
}

double DecisiveLead(double gain) {
  return std::max(kThresholds.refit.beaten_by, kThresholds.refit.beaten_share * gain);
}

RefittedRanking StartRefits(const RefitContext& context, const std::vector<ScoredEffect>& effects,
                            int wanted) {
  RefittedRanking ranked;
  ranked.baseline = RefitWithout(context.model, context.ranking.adopted);
  CHECK(ranked.baseline.message.empty()) << ranked.baseline.message;
  ranked.baseline_evidence = EvidenceOf(ranked.baseline, context.ranking.noise).all;
  for (ScoredEffect& effect :
       ScoredBesideRefit(context, ranked.baseline, effects, /*base_has_adopted=*/true))
    ranked.effects.emplace_back().scored = std::move(effect);
  ranked.refits.resize(effects.size());
  ranked.limit = std::max(kThresholds.refit.most_effects, wanted);
  return ranked;
}

std::vector<size_t> MostPromising(const std::vector<RankedEffect>& effects, int wanted) {
  std::vector<size_t> chosen;
  if (effects.empty() || wanted == 0) return chosen;
  const auto evidence = [&](size_t k) { return effects[k].scored.score.evidence; };
  const RefitThresholds& thresholds = kThresholds.refit;
  const size_t last = std::min(effects.size(), static_cast<size_t>(wanted)) - 1;
  const double least =
      std::min(evidence(0) - thresholds.close_behind, thresholds.share_of_last * evidence(last));
  for (size_t k = 0; k < effects.size() && evidence(k) >= thresholds.least_evidence; ++k)
    if (k <= last || evidence(k) > least) chosen.push_back(k);
  return chosen;
}

std::vector<size_t> LookAlikesOfBest(const std::vector<RankedEffect>& effects) {
  std::vector<size_t> chosen;
  const RankedEffect* best = BestRefitted(effects);
  if (best == nullptr) return chosen;
  const std::vector<std::string>& look_alikes = best->scored.look_alikes;
  for (size_t k = 0; k < effects.size(); ++k) {
    if (&effects[k] == best) continue;
    const std::string& type = effects[k].scored.candidate.type;
    if (std::count(look_alikes.begin(), look_alikes.end(), type) > 0 ||
        AreOfOneFamily(effects[k], *best))
      chosen.push_back(k);
  }
  return chosen;
}

void RefitAll(const RefitContext& context, const std::vector<size_t>& effects,
              RefittedRanking* ranked) {
  for (const size_t effect : effects)
    if (!ranked->effects[effect].refitted && !IsBeaten(*ranked, effect))
      RefitOne(context, effect, ranked->effects[effect].scored, ranked);
}

void RefitAsRankedEarly(const RefitContext& context, const std::vector<ScoredEffect>& early,
                        int wanted, RefittedRanking* ranked) {
  for (size_t k = 0; k < early.size() && static_cast<int>(k) < wanted; ++k) {
    if (early[k].score.evidence < kThresholds.refit.least_evidence) break;
    for (size_t at = 0; at < ranked->effects.size(); ++at)
      if (ranked->effects[at].scored.candidate.type == early[k].candidate.type)
        RefitOne(context, at, early[k], ranked);
  }
}

void LookAlong(const RefitContext& context, const std::string& type, EffectRanking along,
               RefittedRanking* ranked) {
  ranked->pairs.clear();
  ranked->along_type = type;
  ranked->along = std::make_shared<const EffectRanking>(along);
  // Beside the refit with the effect, `along` may have it a second time.
  std::erase_if(along.tried, [&](const TriedVariant& tried) { return tried.type == type; });
  for (const TriedVariant& tried : context.ranking.tried)
    if (tried.type == type) along.tried.push_back(tried);
  ranked->along_for_others = std::make_shared<const EffectRanking>(std::move(along));
  const std::optional<size_t> first = ranked->FindUsable(type);
  std::vector<size_t> others;
  for (size_t effect = 0; effect < ranked->effects.size(); ++effect)
    if (effect != first && ranked->IsUsable(effect)) others.push_back(effect);
  const NoiseLevel& noise = context.ranking.noise;
  std::vector<char> were_far_behind;
  for (const size_t effect : others)
    were_far_behind.push_back(IsFarBehind(*ranked, ranked->refits[effect], noise));
  ranked->best.reset();
  ranked->best_evidence = ranked->underrated = 0;
  // The refit along whose motion the columns were computed tells which others are hopeless.
  if (first) {
    Continue(context, *first, /*was_far_behind=*/false, std::numeric_limits<double>::infinity(),
             context.model.progress, ranked);
    CompareWithBest(noise, *first, ranked);
  }
  const double hopeless_cost = HopelessCost(*ranked, first);
  Progress& progress = *context.model.progress;
  progress.Begin("refit along the motion with " + type, static_cast<int64_t>(others.size()));
  std::atomic<int64_t> done = 0;
  ParallelFor(static_cast<int64_t>(others.size()), 1, [&](int64_t k) {
    const size_t at = static_cast<size_t>(k);
    Progress silent({.style = ProgressStyle::kSilent});
    Continue(context, others[at], were_far_behind[at] != 0, hopeless_cost, &silent, ranked);
    progress.Report(++done);
  });
  progress.End();
  for (const size_t effect : others) CompareWithBest(noise, effect, ranked);
}

void RefitAgain(const RefitContext& context, size_t effect, const Eigen::VectorXd& values,
                const NoiseLevel& noise, RefittedRanking* ranked) {
  const ScoredVariant variant = ranked->effects[effect].scored;
  EffectRefit refit = RefitBeside(context, *ranked, variant, values,
                                  std::numeric_limits<double>::infinity(), context.model.progress);
  if (ranked->TakeIfBetter(effect, {variant, std::move(refit)}, noise))
    CompareWithBest(context.ranking.noise, effect, ranked);
}

RefitNoise WeighRefits(const RefitContext& context, RefittedRanking* ranked) {
  const FittedHypothesis& best = LeastResidual(*ranked, context.ranking.noise);
  const RefitNoise noise{LevelOf(best.residual, best.misfit, best.misfit.jacobian.cols(),
                                 context.model.problem.LeastNoiseVariance()),
                         RmsOverSigma(best)};
  const Comparison comparison{context.model.problem, ranked->baseline, noise.level,
                              ranked->effects.size()};
  for (size_t k = 0; k < ranked->effects.size(); ++k)
    if (ranked->IsUsable(k)) SetEvidence(ranked->refits[k], comparison, &ranked->effects[k]);
  return noise;
}

void RefitRivalNuisances(const RefitContext& context, RefittedRanking* ranked) {
  const RefitThresholds& thresholds = kThresholds.refit;
  const std::vector<ScoredNuisance>& nuisances = context.ranking.nuisances;
  const RankedEffect* best = BestRefitted(ranked->effects);
  if (best == nullptr || best->evidence < thresholds.least_evidence) return;
  const double least = std::max(
      thresholds.rival_nuisance_share * std::min(best->evidence, best->scored.score.evidence),
      thresholds.least_evidence);
  std::vector<size_t> rivals;
  for (size_t k = 0; k < nuisances.size(); ++k)
    if (!nuisances[k].adopted && nuisances[k].evidence > least) rivals.push_back(k);
  std::stable_sort(rivals.begin(), rivals.end(), [&](size_t a, size_t b) {
    return nuisances[a].evidence > nuisances[b].evidence;
  });
  rivals.resize(std::min(rivals.size(), thresholds.most_rival_nuisances));
  if (rivals.empty()) return;
  Progress& progress = *context.model.progress;
  progress.Begin("refit with nuisances", static_cast<int64_t>(rivals.size()));
  std::vector<EffectRefit> refits(rivals.size());
  std::atomic<int64_t> done = 0;
  ParallelFor(static_cast<int64_t>(rivals.size()), 1, [&](int64_t k) {
    const size_t at = static_cast<size_t>(k);
    Progress silent({.style = ProgressStyle::kSilent});
    BaselineModel model = context.model;
    model.progress = &silent;
    refits[at] = RefitWithout(model, context.ranking.adopted.And(nuisances[rivals[at]].candidate));
    progress.Report(++done);
  });
  for (size_t k = 0; k < rivals.size(); ++k)
    if (refits[k].message.empty()) ranked->nuisances[rivals[k]] = std::move(refits[k]);
  progress.End();
}

void WeighNuisances(const RefittedRanking& ranked, const RefitNoise& noise,
                    std::vector<ScoredNuisance>* nuisances) {
  const double before = EvidenceOf(ranked.baseline.hypothesis, noise.level).log_evidence;
  for (const auto& [k, refit] : ranked.nuisances) {
    ScoredNuisance& nuisance = (*nuisances)[k];
    double evidence = EvidenceOf(refit.hypothesis, noise.level).log_evidence - before -
                      nuisance.candidate.selection_penalty - SelectionPenalty(nuisances->size());
    nuisance.refitted.reset();
    if (!std::isfinite(evidence)) continue;
    if (!refit.unconverged.empty()) evidence = std::max(evidence, nuisance.evidence);
    nuisance.refitted = evidence;
  }
}

NuisanceAlternatives RefitInPlaceOfNuisances(const RefitContext& context,
                                             const RefittedRanking& ranked, const RefitNoise& noise,
                                             int wanted) {
  NuisanceAlternatives alternatives;
  const EffectRanking& ranking = context.ranking;
  if (!ranking.adopted.HasMore()) return alternatives;
  const AdoptedNuisances always = ranking.adopted.Always();
  const EffectRefit bare = RefitWithout(context.model, always);
  if (!bare.message.empty()) return alternatives;
  alternatives.bare = bare.errors;
  const Comparison comparison{context.model.problem, bare, noise.level, ranked.effects.size()};
  alternatives.nuisances_evidence =
      EvidenceOf(ranked.baseline.hypothesis, noise.level).log_evidence - comparison.before.all;
  // The effects in their place pay for their selection, too.
  for (const ScoredNuisance& nuisance : ranking.nuisances)
    if (nuisance.adopted && !nuisance.candidate.card.is_always_in_model)
      alternatives.nuisances_evidence -=
          nuisance.candidate.selection_penalty + SelectionPenalty(ranking.nuisances.size());
  const double least = kThresholds.refit.alternative_share * alternatives.nuisances_evidence;
  for (const ScoredEffect& scored :
       ScoredBesideRefit(context, bare, ranking.without_adopted, /*base_has_adopted=*/false)) {
    if (static_cast<int>(alternatives.effects.size()) == wanted || scored.score.evidence < least)
      break;
    RankedEffect& effect = alternatives.effects.emplace_back();
    effect.scored = scored;
    const auto [variant, with] = RefitEffect(context, always, bare, /*is_found=*/false, scored);
    SetRefit(variant, with, &effect);
    HypothesisSpace& space = alternatives.spaces.emplace_back();
    if (!with.message.empty()) continue;
    SetEvidence(with, comparison, &effect);
    space =
        SpaceBeside(with.hypothesis.misfit, with.hypothesis.misfit.jacobian, with.hypothesis.priors,
                    ranking, {effect.scored.candidate.type}, noise.level,
                    /*base_has_adopted=*/false);
  }
  return alternatives;
}

}  // namespace lacuna
