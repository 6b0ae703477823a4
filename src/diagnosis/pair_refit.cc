#include "diagnosis/pair_refit.h"

#include <algorithm>
#include <utility>

#include "core/progress.h"
#include "diagnosis/grip_motions.h"
#include "diagnosis/model_change.h"
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/variant_refit.h"

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

// The scene along the motion with the effect. A nuisance that cannot be simulated there keeps the
// columns of the fitted motion, which `progress` says.
SceneColumns OtherScene(const SceneColumns& of_baseline, const ScoredVariant& effect,
                        std::vector<NuisanceCandidate> nuisances, Progress* progress) {
  SceneColumns scene = of_baseline;
  std::erase_if(nuisances,
                [](const NuisanceCandidate& nuisance) { return nuisance.columns.cols() == 0; });
  for (const NuisanceCandidate& before : of_baseline.nuisances) {
    const bool is_new = std::any_of(
        nuisances.begin(), nuisances.end(),
        [&](const NuisanceCandidate& nuisance) { return nuisance.card.name == before.card.name; });
    if (is_new) continue;
    nuisances.push_back(before);
    if (before.columns.cols() == 0) continue;
    progress->Begin("columns of " + before.card.name, 0);
    progress->End("as along the motion without " + effect.candidate.type +
                  ", because they cannot be simulated along that with it");
  }
  scene.nuisances = std::move(nuisances);
  if (effect.candidate.IsPilot()) scene.pilots.reset();
  return scene;
}

PredictionStudy StudyWith(const BaselineModel& baseline, const ScoredVariant& effect) {
  return WithEffect(baseline.problem.StudyAt(baseline.values), effect);
}

}  // namespace

EffectRanking RankAlong(const BaselineModel& baseline, const ScoredVariant& effect,
                        const EffectRefit& refit, const std::vector<std::string>& without,
                        const DecidedBase& decided) {
  const PredictionStudy study = StudyWith(baseline, effect);
  const CalibrationProblem problem(study, baseline.problem.body()->mesh);
  const Eigen::Index shared = static_cast<Eigen::Index>(baseline.problem.study().fitted.size());
  const Eigen::Index own = static_cast<Eigen::Index>(study.fitted.size()) - shared;
  return RankEffects(problem, refit.values_at_fit, baseline.progress, without,
                     OtherScene(decided.ranking.scene, effect,
                                NuisancesAlong(problem, refit, {shared, own}), baseline.progress),
                     &decided);
}

std::optional<FittedPair> FitPair(const BaselineModel& baseline, const ScoredVariant& first,
                                  const EffectRefit& refit, const std::string& further,
                                  const EffectRanking& ranking, bool is_along_first) {
  const ScoredEffect* scored = ranking.Find(further);
  if (scored == nullptr) return std::nullopt;
  // One elasticity law would replace the other.
  if (first.candidate.replaces_material && scored->candidate.replaces_material) return std::nullopt;
  const PredictionStudy study = StudyWith(baseline, first);
  const CalibrationProblem problem(study, baseline.problem.body()->mesh);
  const Eigen::VectorXd& values = refit.values_at_fit;
  const LinearisedMisfit misfit =
      problem.Linearise(values, {.correspondences = &baseline.misfit, .near = &baseline.misfit});
  if (!misfit.usable) return std::nullopt;
  const BaselineModel model{problem,
                            values,
                            misfit,
                            baseline.progress,
                            baseline.kept,
                            ranking.noise,
                            ranking.ModelError()};
  FittedPair pair;
  pair.first = first.candidate.type;
  pair.second.scored = *scored;
  // First order has predicted the parameters of the model that was ranked, which may be others.
  if (!is_along_first) {
    pair.second.scored.expected_values = values;
    for (ScoredVariant& other : pair.second.scored.elsewhere) other.expected_values = values;
  }
  auto [variant, both] =
      RefitEffect({model, ranking}, ranking.adopted, refit, /*is_found=*/true, pair.second.scored);
  if (!both.message.empty()) return std::nullopt;
  SetRefit(std::move(variant), both, &pair.second);
  pair.both = std::move(both);
  const size_t shared = baseline.problem.study().fitted.size();
  for (size_t k = 0; k < first.candidate.amplitude.size(); ++k)
    pair.sizes_of_first.push_back(pair.both.calibration.estimates[shared + k]);
  // The parameters of the second effect stand before those of the recordings.
  const Eigen::Index own = static_cast<Eigen::Index>(study.fitted.size());
  pair.values_of_first.resize(values.size());
  pair.values_of_first << pair.both.values_at_fit.head(own),
      pair.both.values_at_fit.tail(values.size() - own);
  return pair;
}

}  // namespace lacuna
