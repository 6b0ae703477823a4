#include "diagnosis/pair_refit.h"

#include <algorithm>
#include <utility>

#include "diagnosis/grip_motions.h"
#include "diagnosis/model_change.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/refits.h"

namespace lacuna {
namespace {

// The parameters of a model with one more effect, without those of the effect, which come after
// `shared` ones of the model.
struct SharedParameters {
  Eigen::Index shared, own;

  std::vector<int> Among(Eigen::Index all) const {
    std::vector<int> kept;
    for (Eigen::Index k = 0; k < all; ++k)
      if (k < shared || k >= shared + own) kept.push_back(static_cast<int>(k));
    return kept;
  }
};

// The nuisances that are differences of simulations, along the refit's motion. The effect keeps its
// size in them: what may compensate for a nuisance are the parameters that the rivals of the effect
// have, too. Otherwise a part of the effect would belong to the base of its rivals.
std::vector<NuisanceCandidate> NuisancesAlong(const CalibrationProblem& problem,
                                              const EffectRefit& refit,
                                              const SharedParameters& parameters) {
  PredictionStudy study = problem.StudyAt(refit.values_at_fit);
  study.fitted.resize(static_cast<size_t>(parameters.shared));
  const CalibrationProblem held(study, problem.body()->mesh);
  const std::vector<int> kept = parameters.Among(refit.values_at_fit.size());
  const Eigen::VectorXd values = refit.values_at_fit(kept);
  LinearisedMisfit misfit = refit.at_fit.misfit;
  misfit.jacobian = Eigen::MatrixXd(misfit.jacobian(Eigen::all, kept));
  return SceneNuisances({held, values, misfit, MakeGripMotions(held), {}});
}

SceneColumns OtherScene(const SceneColumns& of_baseline, const ScoredVariant& effect,
                        std::vector<NuisanceCandidate> nuisances) {
  SceneColumns scene = of_baseline;
  // One that cannot be simulated along this motion stays as it was.
  for (const NuisanceCandidate& before : of_baseline.nuisances)
    if (std::none_of(nuisances.begin(), nuisances.end(), [&](const NuisanceCandidate& nuisance) {
          return nuisance.card.name == before.card.name;
        }))
      nuisances.push_back(before);
  scene.nuisances = std::move(nuisances);
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
      values_(refit.values_at_fit) {
  const Eigen::Index shared = static_cast<Eigen::Index>(baseline.problem.study().fitted.size());
  const Eigen::Index own = static_cast<Eigen::Index>(study_.fitted.size()) - shared;
  ranking_ = RankEffects(
      problem_, values_, baseline.progress, without,
      OtherScene(decided.ranking.scene, effect, NuisancesAlong(problem_, refit, {shared, own})),
      &decided);
}

std::optional<WeighedPair> RefittedModel::RefitWith(const std::string& further, double first,
                                                    const NoiseLevel& noise) const {
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
    return WeighedPair{effect_, further, EvidenceOf(both, noise).all - first,
                       SpaceOf(both.hypothesis, ranking_, further, noise),
                       Predicts(both, alone, noise)};
  }
  return std::nullopt;
}

}  // namespace lacuna
