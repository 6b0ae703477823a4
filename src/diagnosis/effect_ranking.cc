#include "diagnosis/effect_ranking.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/decision_rules.h"
#include "diagnosis/hypothesis_score.h"

namespace lacuna {

HypothesisSpace SpaceBeside(const LinearisedMisfit& misfit, const Eigen::MatrixXd& base,
                            std::vector<LinearPrior> priors, const EffectRanking& ranking,
                            const std::vector<std::string>& without, const NoiseLevel& noise,
                            bool base_has_adopted) {
  const auto is_in_base = [&](const TriedVariant& tried) {
    return std::count(without.begin(), without.end(), tried.type) > 0 ||
           (tried.is_adopted && base_has_adopted);
  };
  Eigen::Index width = base.cols() + ranking.unknown_force.cols();
  for (const TriedVariant& tried : ranking.tried)
    if (!is_in_base(tried)) width += tried.columns.cols();
  Eigen::MatrixXd columns(base.rows(), width);
  columns.leftCols(base.cols()) = base;
  Eigen::Index column = base.cols();
  std::vector<WeighedHypothesis> hypotheses;
  const auto add = [&](WeighedHypothesis hypothesis, const Eigen::MatrixXd& own) {
    if (own.cols() == 0) return;
    columns.middleCols(column, own.cols()) = own;
    hypothesis.columns = IndexRange(column, own.cols());
    column += own.cols();
    hypotheses.push_back(std::move(hypothesis));
  };
  for (const TriedVariant& tried : ranking.tried) {
    if (is_in_base(tried)) continue;
    add({tried.is_nuisance ? HypothesisKind::kNuisance : HypothesisKind::kEffect,
         tried.type,
         tried.variant,
         {},
         tried.selection_penalty},
        tried.columns);
    priors.insert(priors.end(), tried.priors.begin(), tried.priors.end());
  }
  WeighedHypothesis unknown;
  unknown.kind = HypothesisKind::kUnknownForce;
  add(std::move(unknown), ranking.unknown_force);
  priors.resize(static_cast<size_t>(width), {0, 1, false});
  HypothesisSpace space = MakeHypothesisSpace(
      WhitenedRows(misfit.residual, misfit, {.correlation_time = noise.correlation_time}),
      WhitenedRows(columns, misfit, {.correlation_time = noise.correlation_time}),
      std::move(priors), base.cols(), std::move(hypotheses), noise.variance, ObservedRows(misfit));
  space.model_error = ranking.ModelError();
  return space;
}

const ScoredEffect* EffectRanking::Find(const std::string& type) const {
  const auto found = std::find_if(effects.begin(), effects.end(), [&](const ScoredEffect& effect) {
    return effect.candidate.type == type;
  });
  return found != effects.end() ? &*found : nullptr;
}

double EffectRanking::ModelError() const {
  double error = 0.5 * kToleratedModelError * explained_misfit;
  for (const ScoredNuisance& nuisance : nuisances) error += nuisance.uncertain_evidence;
  return error;
}

double SelectionPenalty(size_t rivals) {
  return std::log(static_cast<double>(std::max<size_t>(rivals, 1)));
}

}  // namespace lacuna
