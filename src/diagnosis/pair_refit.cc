#include "diagnosis/pair_refit.h"

#include "diagnosis/model_change.h"
#include "diagnosis/refits.h"

namespace lacuna {
namespace {

SceneColumns OtherScene(const SceneColumns& of_baseline, const ScoredVariant& effect) {
  SceneColumns scene = of_baseline;
  scene.nuisances.clear();
  if (effect.candidate.IsPilot()) scene.pilots.reset();
  return scene;
}

}  // namespace

RefittedModel::RefittedModel(const BaselineModel& baseline, const ScoredVariant& effect,
                             const EffectRefit& refit, const std::vector<std::string>& without,
                             const DecidedBase& decided)
    : baseline_(baseline),
      effect_(effect.candidate.type),
      study_(WithEffect(baseline.problem.StudyAt(baseline.values), effect)),
      problem_(study_, baseline.problem.body()->mesh),
      values_(refit.calibration.parameters),
      ranking_(RankEffects(problem_, values_, baseline.progress, without,
                           OtherScene(decided.ranking.scene, effect), &decided)) {}

std::optional<WeighedPair> RefittedModel::RefitWith(const std::string& further) const {
  for (const ScoredEffect& scored : ranking_.effects) {
    if (scored.candidate.type != further) continue;
    const BaselineModel model =
        RankedBaseline(problem_, values_, ranking_, baseline_.progress, baseline_.kept);
    const EffectRefit alone = Refit(model, nullptr, ranking_.adopted, /*is_far_off=*/false);
    RankedEffect effect;
    effect.scored = scored;
    const EffectRefit both = RefitEffect({model, ranking_}, ranking_.adopted, alone,
                                         /*is_found=*/true, &effect);
    if (!alone.message.empty() || !both.message.empty()) return std::nullopt;
    const NoiseLevel& noise = ranking_.noise;
    return WeighedPair{effect_, further, EvidenceOf(both, noise).all - EvidenceOf(alone, noise).all,
                       SpaceOf(both.hypothesis, ranking_, further, noise),
                       Predicts(both, alone, noise)};
  }
  return std::nullopt;
}

}  // namespace lacuna
