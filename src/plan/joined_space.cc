#include "plan/joined_space.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/positive_normal.h"
#include "core/random_bits.h"
#include "diagnosis/projected_hypotheses.h"

namespace lacuna {
namespace {

// Directions of the posterior that the data and the priors leave undetermined: below this share of
// the largest eigenvalue of its scaled precision.
constexpr double kUndetermined = 1e-12;

// N(mean, root rootᵀ)
struct NormalDistribution {
  Eigen::VectorXd mean;
  Eigen::MatrixXd root;
};

// The distribution with the precision P and P mean = right.
NormalDistribution FromPrecision(const Eigen::MatrixXd& precision, const Eigen::VectorXd& right) {
  const Eigen::VectorXd unit =
      precision.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(unit.asDiagonal() * precision * unit.asDiagonal()));
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(right.size());
  for (Eigen::Index k = 0; k < right.size(); ++k) {
    const double value = eigen.eigenvalues()[k];
    if (value > kUndetermined * eigen.eigenvalues().maxCoeff()) spread[k] = 1 / std::sqrt(value);
  }
  NormalDistribution normal;
  normal.root = unit.asDiagonal() * eigen.eigenvectors() * spread.asDiagonal();
  normal.mean = normal.root * (normal.root.transpose() * right);
  return normal;
}

// The distribution given that its component k has this value.
void Condition(Eigen::Index k, double value, NormalDistribution* normal) {
  const Eigen::RowVectorXd own = normal->root.row(k);
  const Eigen::VectorXd gain = normal->root * own.transpose() / own.squaredNorm();
  normal->mean += gain * (value - normal->mean[k]);
  normal->root -= gain * own;
}

// Sets these components of the distribution to a draw from their distribution truncated at 0, and
// the others to their distribution given that.
void SetToPositive(std::vector<Eigen::Index> components, uint64_t bits,
                   NormalDistribution* normal) {
  // Components that are not determined, or known exactly.
  std::erase_if(components, [&](Eigen::Index k) {
    const bool is_fixed = normal->root.row(k).isZero(0);
    if (is_fixed) normal->mean[k] = std::max(normal->mean[k], 0.0);
    return is_fixed;
  });
  if (components.empty()) return;
  const Eigen::MatrixXd roots = normal->root(components, Eigen::all).transpose();
  const Eigen::VectorXd drawn =
      DrawPositive(normal->mean(components), roots.transpose() * roots, bits);
  for (size_t k = 0; k < components.size(); ++k) {
    const Eigen::Index at = static_cast<Eigen::Index>(k);
    const Eigen::Index component = components[k];
    const bool is_known =  // from those before, but for rounding
        normal->root.row(component).squaredNorm() <= kUndetermined * roots.col(at).squaredNorm();
    if (is_known)
      normal->mean[component] = drawn[at];
    else
      Condition(component, drawn[at], normal);
  }
}

// The space of the planned recording alone, with the columns of `now`, after the planned
// recording's own columns have been integrated out. It has no measurements.
HypothesisSpace PlannedSpace(const HypothesisSpace& now, const PlannedColumns& planned) {
  const Eigen::Index base = static_cast<Eigen::Index>(now.base.size());
  const Eigen::Index all = now.model.toward().size();
  const Eigen::Index rows = planned.parameters.rows(), own = planned.own.cols();
  CHECK_LE(planned.parameters.cols(), base);
  CHECK_EQ(planned.variants.cols(), all - base);
  CHECK_EQ(own, static_cast<Eigen::Index>(planned.own_priors.size()));
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, own + all);
  if (own > 0) columns.leftCols(own) = planned.own;
  columns.middleCols(own, planned.parameters.cols()) = planned.parameters;
  columns.rightCols(all - base) = planned.variants;
  std::vector<LinearPrior> priors = planned.own_priors;
  priors.insert(priors.end(), now.model.priors().begin(), now.model.priors().end());
  const HypothesisSpace with_own = MakeHypothesisSpace(
      Eigen::VectorXd::Zero(rows), columns, std::move(priors), own, {}, now.variance, rows);
  HypothesisSpace space = ProjectedHypotheses(with_own).Marginal();
  space.model = LinearGaussianModel::FromProducts(
      0, Eigen::VectorXd::Zero(all), space.model.products().bottomRightCorner(all, all),
      now.model.priors());
  return space;
}

std::vector<WeighedHypothesis> VariantsOf(const HypothesisSpace& space, const std::string& effect) {
  std::vector<WeighedHypothesis> variants;
  for (const WeighedHypothesis& hypothesis : space.hypotheses)
    if (hypothesis.kind == HypothesisKind::kEffect && hypothesis.name == effect)
      variants.push_back(hypothesis);
  return variants;
}

// Each variant of one effect with each of another one.
std::vector<WeighedHypothesis> Combinations(const std::vector<WeighedHypothesis>& first,
                                            const std::vector<WeighedHypothesis>& second) {
  std::vector<WeighedHypothesis> combinations;
  for (const WeighedHypothesis& a : first) {
    for (const WeighedHypothesis& b : second) {
      WeighedHypothesis& both = combinations.emplace_back(a);
      both.variant += ", " + b.variant;
      both.columns.insert(both.columns.end(), b.columns.begin(), b.columns.end());
      both.selection_penalty += b.selection_penalty;
    }
  }
  return combinations;
}

HypothesisSpace SumOf(const HypothesisSpace& now, const HypothesisSpace& planned) {
  HypothesisSpace joined = now;
  joined.model = LinearGaussianModel::FromProducts(now.model.squares(), now.model.toward(),
                                                   now.model.products() + planned.model.products(),
                                                   now.model.priors());
  joined.rows += planned.rows;
  return joined;
}

}  // namespace

HypothesisSpace SpaceOfEffects(const HypothesisSpace& space,
                               const std::vector<std::string>& effects) {
  std::vector<int> columns = space.base;
  std::vector<LinearPrior> priors;
  HypothesisSpace own = space;
  own.hypotheses.clear();
  for (WeighedHypothesis hypothesis : space.hypotheses) {
    if (hypothesis.kind != HypothesisKind::kEffect ||
        std::count(effects.begin(), effects.end(), hypothesis.name) == 0)
      continue;
    const std::vector<int> before = std::exchange(hypothesis.columns, {});
    for (const int column : before) {
      hypothesis.columns.push_back(static_cast<int>(columns.size()));
      columns.push_back(column);
    }
    own.hypotheses.push_back(std::move(hypothesis));
  }
  priors.reserve(columns.size());
  for (const int column : columns) priors.push_back(space.model.Prior(column));
  own.model = LinearGaussianModel::FromProducts(
      space.model.squares(), space.model.toward()(columns),
      space.model.products()(columns, columns), std::move(priors));
  for (size_t k = 0; k < own.base.size(); ++k) own.base[k] = static_cast<int>(k);
  return own;
}

HypothesisSpace SpaceOfRivals(const HypothesisSpace& effects,
                              const std::vector<PlannedRival>& rivals) {
  HypothesisSpace own = effects;
  own.hypotheses.clear();
  for (const PlannedRival& rival : rivals) {
    std::vector<WeighedHypothesis> variants = VariantsOf(effects, rival.effects.front());
    if (rival.IsPair())
      variants = Combinations(variants, VariantsOf(effects, rival.effects.back()));
    for (WeighedHypothesis& variant : variants) {
      variant.name = rival.effect;
      own.hypotheses.push_back(std::move(variant));
    }
  }
  return own;
}

JoinedSpace::JoinedSpace(const HypothesisSpace& now, const PlannedColumns& planned)
    : now_(now),
      planned_(PlannedSpace(now, planned)),
      joined_(SumOf(now, planned_)),
      noise_(planned_) {}

Eigen::VectorXd JoinedSpace::DrawToward(const FoundEffect& truth, uint64_t seed,
                                        uint64_t number) const {
  std::vector<int> known = now_.base;
  known.insert(known.end(), truth.columns.begin(), truth.columns.end());
  Eigen::MatrixXd precision = now_.model.products()(known, known) / now_.variance;
  for (size_t k = 0; k < known.size(); ++k) {
    const double deviation = now_.model.Prior(known[k]).deviation;
    if (std::isfinite(deviation))
      precision(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(k)) +=
          1 / (deviation * deviation);
  }
  // r + A δ is noise, so that the mean of δ solves (AᵀA / v + diag s⁻²) δ = −Aᵀr / v.
  NormalDistribution normal = FromPrecision(precision, -now_.model.toward()(known) / now_.variance);
  std::vector<Eigen::Index> positive;
  for (size_t k = 0; k < known.size(); ++k)
    if (now_.model.Prior(known[k]).positive) positive.push_back(static_cast<Eigen::Index>(k));
  if (!positive.empty())
    SetToPositive(positive,
                  RandomBits({seed, 2 * number, static_cast<uint64_t>(positive.front()), 1}),
                  &normal);
  Eigen::VectorXd amounts = normal.mean;
  for (Eigen::Index k = 0; k < amounts.size(); ++k)
    amounts +=
        Normal(RandomBits({seed, 2 * number, static_cast<uint64_t>(k)})) * normal.root.col(k);
  return joined_.model.toward() + noise_.Draw(seed, 2 * number + 1).toward -
         planned_.model.products()(Eigen::all, known) * amounts;
}

}  // namespace lacuna
