#include "diagnosis/refits.h"

#include <glog/logging.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <utility>

#include "core/parallel.h"
#include "diagnosis/adequacy.h"
#include "diagnosis/projected_hypotheses.h"
#include "diagnosis/removed_misfit.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// Of two refits of one effect that started from different variants.
bool IsBetter(const EffectRefit& a, const EffectRefit& b, const NoiseLevel& noise) {
  if (!a.message.empty() || !b.message.empty()) return a.message.empty();
  return EvidenceOf(a.hypothesis, noise).log_evidence >
         EvidenceOf(b.hypothesis, noise).log_evidence;
}

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

// The cost of the fitted frames above which a refit is negligible beside the best one so far.
double HopelessCost(const RefittedRanking& ranked) {
  if (!ranked.best) return std::numeric_limits<double>::infinity();
  const double best = ranked.refits[*ranked.best].calibration.cost;
  return best + DecisiveLead(ranked.baseline.calibration.cost - best);
}

void RefitOne(const RefitContext& context, size_t effect, RefittedRanking* ranked) {
  RankedEffect& own = ranked->effects[effect];
  if (own.refitted || ranked->count == ranked->limit) return;
  ++ranked->count;
  EffectRefit& refit = ranked->refits[effect];
  const bool is_found = ranked->best && RmsOverSigma(ranked->refits[*ranked->best].hypothesis) <=
                                            kThresholds.refit.converged_rms;
  refit = RefitEffect(context, context.ranking.adopted, ranked->baseline, is_found, &own,
                      HopelessCost(*ranked));
  if (!refit.message.empty()) return;
  own.predicts = Predicts(refit, ranked->baseline, context.ranking.noise);
  if (!own.predicts) return;
  const double evidence = EvidenceOf(refit, context.ranking.noise).all - ranked->baseline_evidence;
  if (evidence <= ranked->best_evidence) return;
  ranked->best = effect;
  ranked->best_evidence = evidence;
  ranked->underrated = std::max(0.0, evidence - own.scored.score.evidence);
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
  effect->evidence = after.all - before.all - SelectionPenalty(comparison.rivals);
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

void PutBesideAlong(const RefitContext& context, size_t effect, RefittedRanking* ranked) {
  if (!ranked->IsUsable(effect)) return;
  EffectRefit& refit = ranked->refits[effect];
  refit = BesideNuisances(context.model, ranked->effects[effect].scored, ranked->along->adopted,
                          std::move(refit));
}

// The hypothesis with the smallest residual: the model without an effect, a refit or a pair.
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
    if (ranked.IsUsable(k)) compare(ranked.refits[k].hypothesis);
  for (const FittedPair& pair : ranked.pairs) compare(pair.both.hypothesis);
  return *best;
}

// The effect with the most evidence after its refit; null: none has evidence.
const RankedEffect* BestRefitted(const std::vector<RankedEffect>& effects) {
  const auto best = std::max_element(
      effects.begin(), effects.end(),
      [](const RankedEffect& a, const RankedEffect& b) { return a.evidence < b.evidence; });
  return best != effects.end() && best->evidence > 0 ? &*best : nullptr;
}

double RmsInNoise(const Eigen::VectorXd& residual, const LinearisedMisfit& misfit) {
  const Eigen::VectorXd white = WhitenedRows(residual, misfit, 0, false);
  const Eigen::Index observed = std::max<Eigen::Index>(1, ObservedRows(misfit));
  return std::sqrt(white.squaredNorm() / static_cast<double>(observed));
}

bool IsFarOff(const LinearisedMisfit& misfit) {
  return RmsInNoise(misfit.residual, misfit) > kFarFromTruth;
}

// The effects with the evidence that first order gives them beside the refitted baseline, where
// that is less, and in that order. The first scores count from the fit as it was, which the
// nuisances of every model may improve by more than any effect does. A fit that is far from the
// measurements is left as it is: there, the columns of these nuisances are differences of motions
// out of phase, which explain much and mean little. `base_has_adopted`: the baseline contains the
// nuisances that the ranking has adopted.
std::vector<ScoredEffect> ScoredBeside(const RefitContext& context, const EffectRefit& baseline,
                                       std::vector<ScoredEffect> effects, bool base_has_adopted) {
  if (IsFarOff(context.ranking.misfit)) return effects;
  const FittedHypothesis& at = baseline.hypothesis;
  const HypothesisSpace space =
      SpaceBeside(at.misfit, at.misfit.jacobian, at.priors, context.ranking, {},
                  context.ranking.noise, base_has_adopted);
  const ProjectedHypotheses beside(space);
  const double penalty = SelectionPenalty(effects.size());
  for (const NamedEvidence& named :
       SumVariants(space, beside.LogBayesFactors(beside.Project(space.model.toward()))))
    for (ScoredEffect& effect : effects) {
      if (named.kind != HypothesisKind::kEffect || named.name != effect.candidate.type) continue;
      const double less = std::max(0.0, effect.score.evidence - (named.evidence - penalty));
      effect.score.evidence -= less;
      for (ScoredVariant& elsewhere : effect.elsewhere) elsewhere.score.evidence -= less;
    }
  std::stable_sort(effects.begin(), effects.end(),
                   [](const ScoredEffect& a, const ScoredEffect& b) {
                     return a.score.evidence > b.score.evidence;
                   });
  return effects;
}

}  // namespace

std::optional<size_t> RefittedRanking::FindUsable(const std::string& type) const {
  for (size_t k = 0; k < effects.size(); ++k)
    if (effects[k].scored.candidate.type == type && IsUsable(k)) return k;
  return std::nullopt;
}

double DecisiveLead(double gain) {
  return std::max(kThresholds.refit.beaten_by, kThresholds.refit.beaten_share * gain);
}

double RmsOverSigma(const FittedHypothesis& hypothesis) {
  return RmsInNoise(hypothesis.residual, hypothesis.misfit);
}

EffectRefit RefitEffect(const RefitContext& context, const AdoptedNuisances& adopted,
                        const EffectRefit& without, bool is_found, RankedEffect* effect,
                        double hopeless_cost) {
  const bool is_far_off = !is_found && RmsOverSigma(without.hypothesis) > kFarFromTruth;
  const auto from = [&](const ScoredVariant& variant, RefitFrom start) {
    return Refit(context.model, &variant, adopted, is_far_off, start, &without, hopeless_cost);
  };
  EffectRefit refit = from(effect->scored, RefitFrom::kFirstOrder);
  ScoredVariant best = effect->scored;
  int predictions = refit.calibration.predictions;
  const auto has_budget = [&] { return predictions < kThresholds.refit.most_of_effect; };
  for (const ScoredVariant& elsewhere : effect->scored.elsewhere) {
    if (elsewhere.score.evidence < kThresholds.refit.variant_share * effect->scored.score.evidence)
      break;
    if (!has_budget()) break;
    EffectRefit other = from(elsewhere, RefitFrom::kFirstOrder);
    predictions += other.calibration.predictions;
    if (!IsBetter(other, refit, context.ranking.noise)) continue;
    refit = std::move(other);
    best = elsewhere;
  }
  if (!effect->scored.candidate.IsPilot() && has_budget() &&
      IsLikelyLocalMinimum(context.ranking, refit, without, effect->scored.score)) {
    EffectRefit other = from(effect->scored, RefitFrom::kFixedSize);
    if (IsBetter(other, refit, context.ranking.noise)) {
      refit = std::move(other);
      best = effect->scored;
    }
  }
  static_cast<ScoredVariant&>(effect->scored) = std::move(best);
  effect->refitted = true;
  effect->refit_message = refit.message;
  effect->errors = refit.errors;
  if (refit.message.empty()) {
    effect->values = refit.effect;
    effect->model = refit.model;
    effect->sizes = refit.sizes;
    effect->others = refit.others;
  }
  return refit;
}

RefittedRanking StartRefits(const RefitContext& context, const std::vector<ScoredEffect>& effects,
                            int wanted) {
  RefittedRanking ranked;
  ranked.baseline = Refit(context.model, nullptr, context.ranking.adopted, false);
  CHECK(ranked.baseline.message.empty()) << ranked.baseline.message;
  ranked.baseline_evidence = EvidenceOf(ranked.baseline, context.ranking.noise).all;
  for (ScoredEffect& effect :
       ScoredBeside(context, ranked.baseline, effects, /*base_has_adopted=*/true))
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
  for (const size_t effect : effects) {
    if (IsBeaten(*ranked, effect)) continue;
    const int before = ranked->count;
    RefitOne(context, effect, ranked);
    if (ranked->along && ranked->count > before) PutBesideAlong(context, effect, ranked);
  }
}

void RefitAsRankedEarly(const RefitContext& context, const std::vector<ScoredEffect>& early,
                        int wanted, RefittedRanking* ranked) {
  for (size_t k = 0; k < early.size() && static_cast<int>(k) < wanted; ++k) {
    if (early[k].score.evidence < kThresholds.refit.least_evidence) break;
    for (size_t at = 0; at < ranked->effects.size(); ++at) {
      RankedEffect& effect = ranked->effects[at];
      if (effect.scored.candidate.type != early[k].candidate.type || effect.refitted) continue;
      // The score stays that of all fitted frames.
      const Score score = std::exchange(effect.scored, early[k]).score;
      RefitOne(context, at, ranked);
      effect.scored.score = score;
    }
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
  ParallelFor(static_cast<int64_t>(ranked->refits.size()), 1, [&](int64_t effect) {
    PutBesideAlong(context, static_cast<size_t>(effect), ranked);
  });
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
    refits[at] =
        Refit(model, nullptr, context.ranking.adopted.And(nuisances[rivals[at]].candidate), false);
    progress.Report(++done);
  });
  for (size_t k = 0; k < rivals.size(); ++k)
    if (refits[k].message.empty()) ranked->nuisances[rivals[k]] = std::move(refits[k].hypothesis);
  progress.End();
}

void WeighNuisances(const RefittedRanking& ranked, const RefitNoise& noise,
                    std::vector<ScoredNuisance>* nuisances) {
  const double before = EvidenceOf(ranked.baseline.hypothesis, noise.level).log_evidence;
  for (const auto& [k, hypothesis] : ranked.nuisances) {
    ScoredNuisance& nuisance = (*nuisances)[k];
    const double evidence = EvidenceOf(hypothesis, noise.level).log_evidence - before -
                            nuisance.candidate.selection_penalty -
                            SelectionPenalty(nuisances->size());
    nuisance.refitted.reset();
    if (std::isfinite(evidence)) nuisance.refitted = evidence;
  }
}

NuisanceAlternatives RefitInPlaceOfNuisances(const RefitContext& context,
                                             const RefittedRanking& ranked, const RefitNoise& noise,
                                             int wanted) {
  NuisanceAlternatives alternatives;
  const EffectRanking& ranking = context.ranking;
  if (!ranking.adopted.HasMore()) return alternatives;
  const AdoptedNuisances always = ranking.adopted.Always();
  const EffectRefit bare = Refit(context.model, nullptr, always, false);
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
       ScoredBeside(context, bare, ranking.without_adopted, /*base_has_adopted=*/false)) {
    if (static_cast<int>(alternatives.effects.size()) == wanted || scored.score.evidence < least)
      break;
    RankedEffect& effect = alternatives.effects.emplace_back();
    effect.scored = scored;
    const EffectRefit with = RefitEffect(context, always, bare, /*is_found=*/false, &effect);
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
