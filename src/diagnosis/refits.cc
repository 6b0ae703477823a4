#include "diagnosis/refits.h"

#include <glog/logging.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <utility>

#include "core/parallel.h"
#include "core/progress.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/fitted_hypothesis.h"
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
  model.noise = ranked.along->ranking->noise;
  model.model_error = ranked.along->ranking->ModelError();
  return model;
}
const AdoptedNuisances& NuisancesOf(const RefitContext& context, const RefittedRanking& ranked) {
  return ranked.along ? ranked.along->ranking->adopted : context.ranking.adopted;
}

// The model with an effect from these values, continued if the fit has not converged.
EffectRefit RefitBeside(const RefitSetting& setting, const ScoredVariant& variant,
                        const Eigen::VectorXd& values, double hopeless_cost) {
  return ContinueWithinBudget(
      setting, &variant, RefitFromValues(setting, &variant, values, hopeless_cost), hopeless_cost);
}

bool AreOfOneFamily(const RankedEffect& a, const RankedEffect& b) {
  const auto &one = a.scored.candidate.effect, &other = b.scored.candidate.effect;
  return one != nullptr && other != nullptr && one->Card().family == other->Card().family &&
         one->Card().family != EffectFamily::kOther;
}

bool IsBeatenToFirstOrder(const RefittedRanking& ranked, size_t effect) {
  // First order may underrate a rival as much as it has underrated the best effect.
  const std::optional<BestRefit>& best = ranked.best;
  const double of_best = best ? best->evidence - best->underrated : 0;
  const double lead = of_best - ranked.effects[effect].scored.score.evidence;
  return lead > DecisiveLead(ranked.BestEvidence());
}

bool IsBeaten(const RefittedRanking& ranked, size_t effect) {
  // A derivative may give no evidence for a member of the best effect's family that is missing; a
  // pilot has been simulated at a finite size.
  const std::optional<BestRefit>& best = ranked.best;
  if (best && AreOfOneFamily(ranked.effects[effect], ranked.effects[best->effect]) &&
      !ranked.effects[effect].scored.candidate.IsPilot())
    return false;
  return IsBeatenToFirstOrder(ranked, effect);
}

// Refits an effect from its variants in another ranking, `early` (null: in its own), and keeps the
// better refit where it has one already. Does nothing if it has none and no further effect may be
// refitted.
void RefitOne(const RefitContext& context, size_t effect, const ScoredEffect* early,
              RefittedRanking* ranked) {
  const RankedEffect& own = ranked->effects[effect];
  if (!own.refitted) {
    if (ranked->count == ranked->limit) return;
    ++ranked->count;
  }
  const std::optional<BestRefit>& best = ranked->best;
  const bool is_found = best && RmsOverSigma(ranked->refits[best->effect].hypothesis) <=
                                    kThresholds.refit.rms_at_noise;
  const BaselineModel model = ModelOf(context, *ranked, context.model.progress);
  // The early part of the motion is ranked where first order may mislead over the whole.
  const RivalRefit rival{
      HopelessCost(*ranked, best ? std::optional(best->effect) : std::nullopt,
                   context.ranking.noise),
      /*is_far_ahead=*/best && early == nullptr && IsBeatenToFirstOrder(*ranked, effect)};
  VariantRefit fitted =
      RefitEffect({model, context.ranking}, NuisancesOf(context, *ranked), ranked->baseline,
                  is_found, early != nullptr ? *early : own.scored, rival);
  // The score stays that of all fitted frames.
  if (early != nullptr) fitted.variant.score = own.scored.score;
  if (ranked->TakeIfBetter(effect, std::move(fitted), context.ranking.noise))
    CompareWithBest(context.ranking.noise, effect, ranked);
}

// The model with a refitted effect, fitted from where it is, beside the columns of
// RefittedRanking::along. If that fails, the refit is settled beside them. One that
// `was_far_behind` stays where it is if no change of its parameters would bring it close.
VariantRefit Continue(const RefitContext& context, const RefittedRanking& ranked, size_t effect,
                      bool was_far_behind, double hopeless_cost, Progress* progress) {
  const ScoredVariant& variant = ranked.effects[effect].scored;
  const EffectRefit& before = ranked.refits[effect];
  const BaselineModel model = ModelOf(context, ranked, progress);
  const RefitSetting setting{model, NuisancesOf(context, ranked)};
  const auto unconverged = [&](EffectRefit refit, const std::string& reason) {
    if (refit.unconverged.empty()) refit.unconverged = reason;
    return VariantRefit{variant, std::move(refit)};
  };
  if (was_far_behind) {
    // In a curved valley a full step gains less than there is to gain.
    constexpr double kGainBeyondFirstOrder = 2;
    const NoiseLevel& noise = context.ranking.noise;
    MovedRefit moved = MovedBeside(setting, variant, before, noise);
    const FirstStep& step = moved.first_step;
    if (moved.refit.message.empty() &&
        (step.cost - kGainBeyondFirstOrder * step.gain > hopeless_cost ||
         IsFarBehind(ranked, variant, moved.refit, noise,
                     kGainBeyondFirstOrder * moved.gain_in_reach)))
      return unconverged(
          std::move(moved.refit),
          "it is too far behind to be fitted along the motion with " + ranked.along->type);
  }
  EffectRefit refit = RefitBeside(setting, variant, before.values_at_fit, hopeless_cost);
  if (refit.message.empty()) return {variant, std::move(refit)};
  return unconverged(
      SettledBeside(setting, variant, before),
      "the fit along the motion with " + ranked.along->type + " has failed: " + refit.message);
}

}  // namespace

RefittedRanking StartRefits(const RefitContext& context, const std::vector<ScoredEffect>& effects,
                            int wanted) {
  RefittedRanking ranked;
  ranked.baseline = RefitWithout({context.model, context.ranking.adopted});
  CHECK(ranked.baseline.message.empty()) << ranked.baseline.message;
  ranked.baseline_evidence = EvidenceOf(ranked.baseline, context.ranking.noise).all;
  for (ScoredEffect& effect :
       ScoredBesideRefit(ranked.baseline.hypothesis, context.ranking, effects,
                         /*base_has_adopted=*/true))
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
      RefitOne(context, effect, /*early=*/nullptr, ranked);
}

void RefitAsRankedEarly(const RefitContext& context, const std::vector<ScoredEffect>& early,
                        int wanted, RefittedRanking* ranked) {
  for (size_t k = 0; k < early.size() && static_cast<int>(k) < wanted; ++k) {
    if (early[k].score.evidence < kThresholds.refit.least_evidence) break;
    for (size_t at = 0; at < ranked->effects.size(); ++at)
      if (ranked->effects[at].scored.candidate.type == early[k].candidate.type)
        RefitOne(context, at, &early[k], ranked);
  }
}

void LookAlong(const RefitContext& context, const std::string& type, EffectRanking along,
               RefittedRanking* ranked) {
  ranked->pairs.clear();
  ranked->failed_pairs.clear();
  auto ranking = std::make_shared<const EffectRanking>(along);
  // Beside the refit with the effect, `along` may have it a second time.
  std::erase_if(along.tried, [&](const TriedVariant& tried) { return tried.type == type; });
  for (const TriedVariant& tried : context.ranking.tried)
    if (tried.type == type) along.tried.push_back(tried);
  ranked->along =
      AlongRefit{type, std::move(ranking), std::make_shared<const EffectRanking>(std::move(along))};
  const std::optional<size_t> first = ranked->FindUsable(type);
  std::vector<size_t> others;
  for (size_t effect = 0; effect < ranked->effects.size(); ++effect)
    if (effect != first && ranked->IsUsable(effect)) others.push_back(effect);
  const NoiseLevel& noise = context.ranking.noise;
  std::vector<char> were_far_behind;
  for (const size_t effect : others)
    were_far_behind.push_back(
        IsFarBehind(*ranked, ranked->effects[effect].scored, ranked->refits[effect], noise));
  ranked->best.reset();
  // The refit along whose motion the columns were computed tells which others are hopeless.
  if (first) {
    ranked->Take(*first, Continue(context, *ranked, *first, /*was_far_behind=*/false,
                                  std::numeric_limits<double>::infinity(), context.model.progress));
    CompareWithBest(noise, *first, ranked);
  }
  const double hopeless_cost = HopelessCost(*ranked, first, noise);
  Progress& progress = *context.model.progress;
  progress.Begin("refit along the motion with " + type, static_cast<int64_t>(others.size()));
  std::vector<VariantRefit> continued(others.size());
  std::atomic<int64_t> done = 0;
  ParallelFor(static_cast<int64_t>(others.size()), 1, [&](int64_t k) {
    const size_t at = static_cast<size_t>(k);
    Progress silent({.style = ProgressStyle::kSilent});
    continued[at] =
        Continue(context, *ranked, others[at], were_far_behind[at] != 0, hopeless_cost, &silent);
    progress.Report(++done);
  });
  progress.End();
  for (size_t k = 0; k < others.size(); ++k) {
    ranked->Take(others[k], std::move(continued[k]));
    CompareWithBest(noise, others[k], ranked);
  }
}

void RefitAgain(const RefitContext& context, size_t effect, const Eigen::VectorXd& values,
                const NoiseLevel& noise, RefittedRanking* ranked) {
  const ScoredVariant variant = ranked->effects[effect].scored;
  const BaselineModel model = ModelOf(context, *ranked, context.model.progress);
  EffectRefit refit = RefitBeside({model, NuisancesOf(context, *ranked)}, variant, values,
                                  std::numeric_limits<double>::infinity());
  if (ranked->TakeIfBetter(effect, {variant, std::move(refit)}, noise))
    CompareWithBest(context.ranking.noise, effect, ranked);
}

}  // namespace lacuna
