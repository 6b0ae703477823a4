#include "plan/joined_space.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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

// A draw from the standard normal distribution truncated to values of at least `least` (Robert,
// Simulation of truncated normal variables, Statistics and Computing 5, 1995).
double NormalAbove(double least, uint64_t bits) {
  CHECK(std::isfinite(least));
  const double rate = 0.5 * (least + std::hypot(least, 2.0));
  for (uint64_t attempt = 0;; ++attempt) {
    const uint64_t proposal = RandomBits({bits, attempt, 0});
    const double value = least <= 0 ? Normal(proposal) : least - std::log(Uniform(proposal)) / rate;
    if (value < least) continue;
    if (least <= 0 ||
        Uniform(RandomBits({bits, attempt, 1})) <= std::exp(-0.5 * (value - rate) * (value - rate)))
      return value;
  }
}

// Sets the component k of the distribution to a draw from its marginal distribution truncated at 0,
// and the others to their distribution given that.
void DrawPositive(Eigen::Index k, uint64_t bits, NormalDistribution* normal) {
  const Eigen::RowVectorXd own = normal->root.row(k);
  const double deviation = own.norm();
  if (!(deviation > 0)) {  // not determined, or known exactly
    normal->mean[k] = std::max(normal->mean[k], 0.0);
    return;
  }
  const double drawn =
      normal->mean[k] + deviation * NormalAbove(-normal->mean[k] / deviation, bits);
  const Eigen::VectorXd gain = normal->root * own.transpose() / own.squaredNorm();
  normal->mean += gain * (drawn - normal->mean[k]);
  normal->root -= gain * own;
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
  NormalDistribution normal = FromPrecision(precision, -now_.model.toward()(known) / now_.variance);
  for (size_t k = known.size(); k-- > 0;)  // the amounts of the effect come last
    if (now_.model.Prior(known[k]).positive)
      DrawPositive(static_cast<Eigen::Index>(k), RandomBits({seed, 2 * number, k, 1}), &normal);
  Eigen::VectorXd amounts = normal.mean;
  for (Eigen::Index k = 0; k < amounts.size(); ++k)
    amounts +=
        Normal(RandomBits({seed, 2 * number, static_cast<uint64_t>(k)})) * normal.root.col(k);
  return joined_.model.toward() + noise_.Draw(seed, 2 * number + 1).toward -
         planned_.model.products()(Eigen::all, known) * amounts;
}

}  // namespace lacuna
