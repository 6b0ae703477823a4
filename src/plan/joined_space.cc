#include "plan/joined_space.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

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
    : now_(now), own_(planned.own.cols()) {
  const Eigen::Index base = static_cast<Eigen::Index>(now.base.size());
  const Eigen::Index all = now.model.toward().size();
  const Eigen::Index rows = planned.parameters.rows();
  CHECK_LE(planned.parameters.cols(), base);
  CHECK_EQ(planned.variants.cols(), all - base);
  CHECK_EQ(planned.own.cols(), static_cast<Eigen::Index>(planned.own_priors.size()));
  Eigen::MatrixXd columns = Eigen::MatrixXd::Zero(rows, all + own_);
  columns.leftCols(planned.parameters.cols()) = planned.parameters;
  if (own_ > 0) columns.middleCols(base, own_) = planned.own;
  columns.rightCols(all - base) = planned.variants;
  std::vector<LinearPrior> priors = now.model.priors();
  priors.insert(priors.begin() + base, planned.own_priors.begin(), planned.own_priors.end());
  std::vector<WeighedHypothesis> hypotheses = now.hypotheses;
  for (WeighedHypothesis& hypothesis : hypotheses)
    for (int& column : hypothesis.columns) column += static_cast<int>(own_);
  planned_ = MakeHypothesisSpace(Eigen::VectorXd::Zero(rows), columns, priors, base + own_,
                                 std::move(hypotheses), now.variance, rows);
  noise_.emplace(planned_);
  joined_ = planned_;
  joined_.rows += now.rows;
  Eigen::VectorXd toward = Eigen::VectorXd::Zero(all + own_);
  toward.head(base) = now.model.toward().head(base);
  toward.tail(all - base) = now.model.toward().tail(all - base);
  Eigen::MatrixXd products = planned_.model.products();
  const auto add = [&](Eigen::Index to_row, Eigen::Index to_column, Eigen::Index row,
                       Eigen::Index column, Eigen::Index height, Eigen::Index width) {
    products.block(to_row, to_column, height, width) +=
        now.model.products().block(row, column, height, width);
  };
  add(0, 0, 0, 0, base, base);
  add(0, base + own_, 0, base, base, all - base);
  add(base + own_, 0, base, 0, all - base, base);
  add(base + own_, base + own_, base, base, all - base, all - base);
  joined_.model = LinearGaussianModel::FromProducts(now.model.squares(), std::move(toward),
                                                    std::move(products), std::move(priors));
}

FoundEffect JoinedSpace::InJoined(FoundEffect found) const {
  for (int& column : found.columns) column += static_cast<int>(own_);
  return found;
}

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
  // r + A δ is noise, so that the mean of δ solves P δ = −Aᵀr / v.
  Eigen::VectorXd amounts =
      DrawNormal(precision, -now_.model.toward()(known) / now_.variance, seed, 2 * number);
  for (size_t k = 0; k < known.size(); ++k) {
    double& amount = amounts[static_cast<Eigen::Index>(k)];
    if (now_.model.Prior(known[k]).positive) amount = std::max(amount, 0.0);
  }
  std::vector<int> in_joined = now_.base;
  for (const int column : truth.columns) in_joined.push_back(column + static_cast<int>(own_));
  const Eigen::VectorXd noise = noise_->Draw(seed, 2 * number + 1).toward;
  return joined_.model.toward() + noise -
         planned_.model.products()(Eigen::all, in_joined) * amounts;
}

}  // namespace lacuna
