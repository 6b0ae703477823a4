#include "diagnosis/scored_beside.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "calibration/calibration_problem.h"
#include "calibration/linear_misfit.h"
#include "diagnosis/projected_hypotheses.h"

namespace lacuna {

std::vector<ScoredEffect> ScoredBeside(const HypothesisSpace& space,
                                       std::vector<ScoredEffect> effects) {
  const ProjectedHypotheses beside(space);
  const Eigen::VectorXd factors = beside.FactorsOfResidual();
  const auto more_evidence = [](const ScoredVariant& a, const ScoredVariant& b) {
    return a.score.evidence > b.score.evidence;
  };
  const double of_effects = SelectionPenalty(effects.size());
  for (ScoredEffect& effect : effects) {
    std::vector<size_t> own;  // hypotheses
    for (size_t h = 0; h < space.hypotheses.size(); ++h)
      if (space.hypotheses[h].kind == HypothesisKind::kEffect &&
          space.hypotheses[h].name == effect.candidate.type)
        own.push_back(h);
    const double penalty = of_effects + SelectionPenalty(own.size());
    std::vector<ScoredVariant> variants{effect};
    std::move(effect.elsewhere.begin(), effect.elsewhere.end(), std::back_inserter(variants));
    for (ScoredVariant& variant : variants) {
      const auto same = std::find_if(own.begin(), own.end(), [&](size_t h) {
        return space.hypotheses[h].variant == variant.candidate.variant;
      });
      if (same == own.end()) continue;
      const double evidence = factors[static_cast<Eigen::Index>(*same)] - penalty;
      variant.score.evidence = std::min(variant.score.evidence, evidence);
    }
    std::stable_sort(variants.begin(), variants.end(), more_evidence);
    static_cast<ScoredVariant&>(effect) = std::move(variants.front());
    effect.elsewhere.assign(std::make_move_iterator(variants.begin() + 1),
                            std::make_move_iterator(variants.end()));
  }
  std::stable_sort(effects.begin(), effects.end(), more_evidence);
  return effects;
}

std::vector<ScoredEffect> ScoredBesideRefit(const FittedHypothesis& baseline,
                                            const EffectRanking& ranking,
                                            std::vector<ScoredEffect> effects,
                                            bool base_has_adopted) {
  const LinearisedMisfit& misfit = ranking.misfit;
  if (RmsOverSigma(misfit.residual, misfit) > kFarFromTruth) return effects;
  return ScoredBeside(SpaceBeside(baseline.misfit, baseline.misfit.jacobian, baseline.priors,
                                  ranking, {}, ranking.noise, base_has_adopted),
                      std::move(effects));
}

}  // namespace lacuna
