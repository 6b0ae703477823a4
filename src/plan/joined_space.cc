#include "plan/joined_space.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "diagnosis/projected_hypotheses.h"
#include "scan/random_bits.h"

namespace lacuna {
namespace {

// Directions of the posterior that the data and the priors leave undetermined: below this share of
// the largest eigenvalue of its scaled precision.
constexpr double kUndetermined = 1e-12;

// A draw from N(mean, covariance) with the precision P and P mean = right.
Eigen::VectorXd DrawNormal(const Eigen::MatrixXd& precision, const Eigen::VectorXd& right,
                           uint64_t seed, uint64_t number) {
  const Eigen::VectorXd unit =
      precision.diagonal().cwiseMax(std::numeric_limits<double>::min()).cwiseSqrt().cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
      Eigen::MatrixXd(unit.asDiagonal() * precision * unit.asDiagonal()));
  const Eigen::VectorXd along = eigen.eigenvectors().transpose() * (unit.asDiagonal() * right);
  Eigen::VectorXd amounts = Eigen::VectorXd::Zero(right.size());
  for (Eigen::Index k = 0; k < right.size(); ++k) {
    const double value = eigen.eigenvalues()[k];
    if (value <= kUndetermined * eigen.eigenvalues().maxCoeff()) continue;
    const double normal = Normal(RandomBits({seed, number, static_cast<uint64_t>(k)}));
    amounts[k] = along[k] / value + normal / std::sqrt(value);
  }
  return unit.asDiagonal() * (eigen.eigenvectors() * amounts);
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

HypothesisSpace SumOf(const HypothesisSpace& now, const HypothesisSpace& planned) {
  HypothesisSpace joined = now;
  joined.model = LinearGaussianModel::FromProducts(now.model.squares(), now.model.toward(),
                                                   now.model.products() + planned.model.products(),
                                                   now.model.priors());
  joined.rows += planned.rows;
  return joined;
}

}  // namespace

HypothesisSpace SpaceOfRivals(const HypothesisSpace& space,
                              const std::vector<std::string>& rivals) {
  std::vector<int> columns = space.base;
  std::vector<LinearPrior> priors;
  HypothesisSpace own = space;
  own.hypotheses.clear();
  for (WeighedHypothesis hypothesis : space.hypotheses) {
    if (hypothesis.kind != HypothesisKind::kEffect ||
        std::count(rivals.begin(), rivals.end(), hypothesis.name) == 0)
      continue;
    const std::vector<int> before = std::exchange(hypothesis.columns, {});
    for (const int column : before) {
      hypothesis.columns.push_back(static_cast<int>(columns.size()));
      columns.push_back(column);
    }
    own.hypotheses.push_back(std::move(hypothesis));
  }
  for (const int column : columns) priors.push_back(space.model.Prior(column));
  own.model = LinearGaussianModel::FromProducts(
      space.model.squares(), space.model.toward()(columns),
      space.model.products()(columns, columns), std::move(priors));
  for (size_t k = 0; k < own.base.size(); ++k) own.base[k] = static_cast<int>(k);
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
  Eigen::VectorXd amounts =
      DrawNormal(precision, -now_.model.toward()(known) / now_.variance, seed, 2 * number);
  for (size_t k = 0; k < known.size(); ++k) {
    double& amount = amounts[static_cast<Eigen::Index>(k)];
    if (now_.model.Prior(known[k]).positive) amount = std::max(amount, 0.0);
  }
  return joined_.model.toward() + noise_.Draw(seed, 2 * number + 1).toward -
         planned_.model.products()(Eigen::all, known) * amounts;
}

}  // namespace lacuna
