#include "diagnosis/refit_comparison.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "diagnosis/effect_ranking.h"
#include "diagnosis/fitted_hypothesis.h"
#include "diagnosis/removed_misfit.h"

namespace lacuna {
namespace {

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

}  // namespace

void SetEvidence(const EffectRefit& with, const RefitComparison& comparison, RankedEffect* effect) {
  const RefitEvidence& before = comparison.before;
  const RefitEvidence after = EvidenceOf(with, comparison.noise);
  effect->predicts = Predicts(with, comparison.without, comparison.noise);
  effect->fails_at_limit = with.unconverged.empty() && with.IsAtLimit() &&
                           IsContradicted(with, comparison.without, comparison.noise);
  effect->removed.reset();
  effect->penalty_of_effects = SelectionPenalty(comparison.rivals);
  effect->evidence =
      after.all - before.all - effect->penalty_of_effects - effect->scored.selection_penalty;
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

bool PairPredicts(const FittedPair& pair, const RefittedRanking& ranked, const NoiseLevel& noise) {
  constexpr int kTests = 3;
  const auto beyond = [&](const std::string& type) {
    const std::optional<size_t> alone = ranked.FindUsable(type);
    return !alone || Predicts(pair.both, ranked.refits[*alone], noise, kTests);
  };
  return Predicts(pair.both, ranked.baseline, noise, kTests) && beyond(pair.first) &&
         beyond(pair.second.scored.candidate.type);
}

RefitNoise WeighRefits(const RefitContext& context, RefittedRanking* ranked) {
  const FittedHypothesis& best = LeastResidual(*ranked, context.ranking.noise);
  const RefitNoise noise{LevelOf(best.residual, best.misfit, best.misfit.jacobian.cols(),
                                 context.model.problem.LeastNoiseVariance()),
                         RmsOverSigma(best)};
  const RefitComparison comparison{context.model.problem, ranked->baseline, noise.level,
                                   ranked->effects.size()};
  for (size_t k = 0; k < ranked->effects.size(); ++k)
    if (ranked->IsUsable(k)) SetEvidence(ranked->refits[k], comparison, &ranked->effects[k]);
  return noise;
}

}  // namespace lacuna
