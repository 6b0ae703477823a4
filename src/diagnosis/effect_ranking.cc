#include "diagnosis/effect_ranking.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "diagnosis/decision_rules.h"
#include "diagnosis/hypothesis_score.h"

namespace lacuna {

WhitenedHypotheses::WhitenedHypotheses(const EffectRanking& ranking, const LinearisedMisfit& misfit,
                                       const NoiseLevel& noise)
    : ranking_(ranking), misfit_(misfit), noise_(noise) {
  for (const TriedVariant& tried : ranking.tried) {
    Add({{tried.is_nuisance ? HypothesisKind::kNuisance : HypothesisKind::kEffect,
          tried.type,
          tried.variant,
          {},
          tried.selection_penalty},
         tried.is_adopted},
        tried.columns.cols());
    priors_.insert(priors_.end(), tried.priors.begin(), tried.priors.end());
  }
  Tried unknown;
  unknown.hypothesis.kind = HypothesisKind::kUnknownForce;
  const Eigen::Index first_unknown = static_cast<Eigen::Index>(priors_.size());
  priors_.resize(priors_.size() + static_cast<size_t>(ranking.unknown_force.cols()), {0, 1, false});
  Add(std::move(unknown), ranking.unknown_force.cols());

  Eigen::MatrixXd columns(misfit.residual.size(), static_cast<Eigen::Index>(priors_.size()));
  Eigen::Index column = 0;
  for (const TriedVariant& tried : ranking.tried) {
    if (tried.columns.cols() == 0) continue;
    columns.middleCols(column, tried.columns.cols()) = tried.columns;
    column += tried.columns.cols();
  }
  CHECK_EQ(column, first_unknown);
  if (ranking.unknown_force.cols() > 0)
    columns.rightCols(ranking.unknown_force.cols()) = ranking.unknown_force;
  columns_ = WhitenedRows(columns, misfit, {.correlation_time = noise.correlation_time});
  products_ = columns_.transpose() * columns_;
}

void WhitenedHypotheses::Add(Tried tried, Eigen::Index width) {
  if (width == 0) return;
  const Eigen::Index first =
      tried_.empty() ? 0 : Eigen::Index{tried_.back().hypothesis.columns.back()} + 1;
  tried.hypothesis.columns = IndexRange(first, width);
  tried_.push_back(std::move(tried));
}

bool WhitenedHypotheses::WhitensLike(const LinearisedMisfit& misfit) const {
  return std::equal(
      misfit_.parts.begin(), misfit_.parts.end(), misfit.parts.begin(), misfit.parts.end(),
      [](const LinearisedMisfit::Part& a, const LinearisedMisfit::Part& b) {
        return a.first_row == b.first_row && a.errors.noise == b.errors.noise &&
               a.errors.common == b.errors.common && a.layout.series == b.layout.series &&
               a.layout.times == b.layout.times && a.layout.count == b.layout.count &&
               a.layout.deformation == b.layout.deformation &&
               a.layout.offset_ids == b.layout.offset_ids;
      });
}

HypothesisSpace WhitenedHypotheses::Beside(const LinearisedMisfit& misfit,
                                           const Eigen::MatrixXd& base,
                                           const std::vector<LinearPrior>& priors,
                                           const std::vector<std::string>& without,
                                           bool base_has_adopted) const {
  CHECK(WhitensLike(misfit));
  const auto whitened = [&](const Eigen::MatrixXd& rows) {
    return WhitenedRows(rows, misfit, {.correlation_time = noise_.correlation_time});
  };
  const Eigen::VectorXd residual = whitened(misfit.residual);
  const Eigen::MatrixXd of_base = whitened(base);
  HypothesisSpace space = MakeHypothesisSpace(residual, of_base, priors, base.cols(), {},
                                              noise_.variance, ObservedRows(misfit));
  std::vector<int> kept;  // indices in `columns_`
  std::vector<LinearPrior> all_priors = space.model.priors();
  for (const Tried& tried : tried_) {
    const WeighedHypothesis& one = tried.hypothesis;
    const bool is_in_base = one.kind != HypothesisKind::kUnknownForce &&
                            (std::count(without.begin(), without.end(), one.name) > 0 ||
                             (tried.is_adopted && base_has_adopted));
    if (is_in_base) continue;
    space.hypotheses.push_back(one);
    space.hypotheses.back().columns = IndexRange(static_cast<Eigen::Index>(all_priors.size()),
                                                 static_cast<Eigen::Index>(one.columns.size()));
    kept.insert(kept.end(), one.columns.begin(), one.columns.end());
    for (const int column : one.columns) all_priors.push_back(priors_[static_cast<size_t>(column)]);
  }
  // The residual of the space is that of the base at the means of its priors.
  Eigen::VectorXd means = Eigen::VectorXd::Zero(base.cols());
  for (Eigen::Index k = 0; k < base.cols(); ++k) {
    const LinearPrior& prior = priors[static_cast<size_t>(k)];
    if (std::isfinite(prior.deviation)) means[k] = prior.mean;
  }
  const Eigen::VectorXd toward = columns_.transpose() * (residual + of_base * means);
  const Eigen::MatrixXd with_base = columns_.transpose() * of_base;
  const Eigen::Index count = base.cols(), size = static_cast<Eigen::Index>(all_priors.size());
  Eigen::VectorXd all_toward(size);
  all_toward << space.model.toward(), toward(kept);
  Eigen::MatrixXd all_products(size, size);
  all_products.topLeftCorner(count, count) = space.model.products();
  all_products.bottomLeftCorner(size - count, count) = with_base(kept, Eigen::all);
  all_products.topRightCorner(count, size - count) = with_base(kept, Eigen::all).transpose();
  all_products.bottomRightCorner(size - count, size - count) = products_(kept, kept);
  space.model = LinearGaussianModel::FromProducts(space.model.squares(), std::move(all_toward),
                                                  std::move(all_products), std::move(all_priors));
  space.model_error = ranking_.ModelError();
  return space;
}

HypothesisSpace SpaceBeside(const LinearisedMisfit& misfit, const Eigen::MatrixXd& base,
                            const std::vector<LinearPrior>& priors, const EffectRanking& ranking,
                            const std::vector<std::string>& without, const NoiseLevel& noise,
                            bool base_has_adopted) {
  return WhitenedHypotheses(ranking, misfit, noise)
      .Beside(misfit, base, priors, without, base_has_adopted);
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
