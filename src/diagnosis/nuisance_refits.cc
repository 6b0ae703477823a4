#include "diagnosis/nuisance_refits.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "core/parallel.h"
#include "core/progress.h"
#include "diagnosis/effect_ranking.h"
#include "diagnosis/effect_refit.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/refit_comparison.h"
#include "diagnosis/scored_beside.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// A nuisance is put into the study so many times, or until what remains of it is this share of the
// deviation of its prior, whose square a linear column neglects.
constexpr int kMostApplied = 4;
constexpr double kSmallRest = 0.1;

bool IsSmall(const Eigen::VectorXd& amounts, const std::vector<LinearPrior>& priors) {
  for (Eigen::Index k = 0; k < amounts.size(); ++k)
    if (!(std::abs(amounts[k]) <= kSmallRest * priors[static_cast<size_t>(k)].deviation))
      return false;
  return true;
}

// The refit with a nuisance. Where the nuisance can be put into the study, columns stand only for
// what remains of it.
EffectRefit RefitWithNuisance(const BaselineModel& baseline, const AdoptedNuisances& adopted,
                              const NuisanceCandidate& nuisance, const NoiseLevel& noise) {
  EffectRefit best = RefitWithout({baseline, adopted.And(nuisance)});
  if (!nuisance.apply) return best;
  const Eigen::Index width = nuisance.columns.cols();
  StudyBesideNuisance beside{baseline.problem.WithEstimatedNoise(), nuisance.priors};
  EffectRefit refit = best;
  for (int k = 0; k < kMostApplied && refit.message.empty(); ++k) {
    const Eigen::VectorXd amounts = refit.nuisance_amounts.tail(width);
    if (IsSmall(amounts, beside.priors)) break;
    nuisance.apply(amounts, &beside);
    const CalibrationProblem problem(beside.study, baseline.problem.body()->mesh);
    const Eigen::VectorXd values = refit.calibration.parameters;
    const LinearisedMisfit misfit = problem.Linearise(
        values,
        {.with_jacobian = true, .correspondences = &baseline.misfit, .near = &baseline.misfit});
    if (!misfit.usable || misfit.residual.size() != baseline.misfit.residual.size()) break;
    std::optional<NuisanceCandidate> rest =
        ModelNuisanceNamed(nuisance.card.name, {problem, values, misfit, {}, {}});
    if (!rest || rest->columns.cols() != width) break;
    rest->priors = beside.priors;
    BaselineModel model{problem,
                        values,
                        misfit,
                        baseline.progress,
                        baseline.kept,
                        baseline.noise,
                        baseline.model_error};
    refit = RefitWithout({model, adopted.And(*rest)});
    if (refit.message.empty() && EvidenceOf(refit.hypothesis, noise).log_evidence >
                                     EvidenceOf(best.hypothesis, noise).log_evidence)
      best = refit;
  }
  return best;
}

}  // namespace

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
    refits[at] = RefitWithNuisance(model, context.ranking.adopted, nuisances[rivals[at]].candidate,
                                   context.ranking.noise);
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
  const EffectRefit bare = RefitWithout({context.model, always});
  if (!bare.message.empty()) return alternatives;
  alternatives.bare = bare.errors;
  const RefitComparison comparison{context.model.problem, bare, noise.level, ranked.effects.size()};
  alternatives.nuisances_evidence =
      EvidenceOf(ranked.baseline.hypothesis, noise.level).log_evidence - comparison.before.all;
  // The effects in their place pay for their selection, too.
  for (const ScoredNuisance& nuisance : ranking.nuisances)
    if (nuisance.adopted && !nuisance.candidate.card.is_always_in_model)
      alternatives.nuisances_evidence -=
          nuisance.candidate.selection_penalty + SelectionPenalty(ranking.nuisances.size());
  const double least = kThresholds.refit.alternative_share * alternatives.nuisances_evidence;
  for (const ScoredEffect& scored :
       ScoredBesideRefit(bare.hypothesis, ranking, ranking.without_adopted,
                         /*base_has_adopted=*/false)) {
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
