#include "diagnosis/projected_hypotheses.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/positive_normal.h"

namespace lacuna {
namespace {

// What remains of a column after a projection is rounding below this share of its square.
constexpr double kProjectionRounding = 1e-9;

bool IsForce(const WeighedHypothesis& hypothesis) {
  return hypothesis.kind == HypothesisKind::kUnknownForce && !hypothesis.columns.empty();
}

// (A + diag(d))⁻¹ of a positive semidefinite A, scaled to a unit diagonal for its accuracy.
Eigen::MatrixXd RegularInverse(Eigen::MatrixXd matrix, const Eigen::VectorXd& more) {
  matrix.diagonal() += more;
  matrix.diagonal() = matrix.diagonal().cwiseMax(std::numeric_limits<double>::min());
  const Eigen::VectorXd unit = matrix.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = unit.asDiagonal() * matrix * unit.asDiagonal();
  const Eigen::Index size = matrix.rows();
  return unit.asDiagonal() * scaled.ldlt().solve(Eigen::MatrixXd::Identity(size, size)) *
         unit.asDiagonal();
}

Eigen::VectorXd InverseSquares(const std::vector<LinearPrior>& priors,
                               const std::vector<int>& columns) {
  Eigen::VectorXd inverse(static_cast<Eigen::Index>(columns.size()));
  for (size_t k = 0; k < columns.size(); ++k) {
    const double deviation = priors[static_cast<size_t>(columns[k])].deviation;
    inverse[static_cast<Eigen::Index>(k)] =
        std::isfinite(deviation) ? 1 / (deviation * deviation) : 0;
  }
  return inverse;
}

}  // namespace

ProjectedHypotheses::ProjectedHypotheses(const HypothesisSpace& space,
                                         const std::vector<int>& further)
    : space_(space), taken_(space.base) {
  taken_.insert(taken_.end(), further.begin(), further.end());
  const LinearGaussianModel& model = space.model;
  inverse_ = RegularInverse(model.products()(taken_, taken_),
                            space.variance * InverseSquares(model.priors(), taken_));
  weights_ = inverse_ * model.products()(taken_, Eigen::all);
  products_ = model.products() - model.products()(Eigen::all, taken_) * weights_;
  for (Eigen::Index k = 0; k < products_.cols(); ++k)
    if (products_(k, k) < kProjectionRounding * model.products()(k, k)) {
      products_.row(k).setZero();
      products_.col(k).setZero();
    }
  for (const WeighedHypothesis& hypothesis : space.hypotheses) own_.push_back(Prepare(hypothesis));
  for (const WeighedHypothesis& hypothesis : space.hypotheses) {
    if (!IsForce(hypothesis)) continue;
    CHECK(force_.values.size() == 0) << "a space has one unknown force";
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        Eigen::MatrixXd(products_(hypothesis.columns, hypothesis.columns)));
    // In ascending order.
    const double least = kProjectionRounding * std::max(0.0, eigen.eigenvalues().tail<1>()[0]);
    const Eigen::Index rank = (eigen.eigenvalues().array() > least).count();
    force_ = {eigen.eigenvectors().rightCols(rank), eigen.eigenvalues().tail(rank)};
  }
}

double ProjectedHypotheses::LogBayesFactorOfForce(const Eigen::VectorXd& toward) const {
  const Eigen::ArrayXd squares = (force_.vectors.transpose() * toward).array().square();
  const Eigen::ArrayXd values = force_.values.array();
  std::vector<double> factors;
  for (const double scale : kForceScales) {
    const double ratio = space_.variance / (scale * scale);
    factors.push_back(0.5 * (squares / (values + ratio)).sum() / space_.variance -
                      0.5 * (1 + values / ratio).log().sum());
  }
  return LogMeanExp(factors);
}

ProjectedHypotheses::Own ProjectedHypotheses::Prepare(const WeighedHypothesis& hypothesis) const {
  Own own;
  const std::vector<int>& columns = hypothesis.columns;
  own.taken = std::any_of(columns.begin(), columns.end(), [&](int column) {
    return std::count(taken_.begin(), taken_.end(), column) > 0;
  });
  if (own.taken || columns.empty() || hypothesis.kind == HypothesisKind::kUnknownForce) return own;
  const std::vector<LinearPrior>& priors = space_.model.priors();
  for (size_t k = 0; k < columns.size(); ++k)
    if (priors[static_cast<size_t>(columns[k])].positive)
      own.positive.push_back(static_cast<Eigen::Index>(k));
  const Eigen::MatrixXd visible = products_(columns, columns);
  const Eigen::Index size = visible.rows();
  const Eigen::VectorXd inverse_prior = InverseSquares(priors, columns);
  own.gain = 0.5 / space_.variance * RegularInverse(visible, space_.variance * inverse_prior);
  own.covariance = 2 * space_.variance * space_.variance * own.gain;
  const Eigen::VectorXd unit = inverse_prior.cwiseSqrt().cwiseInverse();
  Eigen::MatrixXd spread = unit.asDiagonal() * visible * unit.asDiagonal() / space_.variance;
  spread += Eigen::MatrixXd::Identity(size, size);
  own.occam = 0.5 * spread.ldlt().vectorD().cwiseMax(1e-300).array().log().sum();
  return own;
}

Eigen::VectorXd ProjectedHypotheses::Project(const Eigen::VectorXd& toward) const {
  return toward - weights_.transpose() * toward(taken_);
}

double ProjectedHypotheses::Misfit(const ResidualProducts& residual) const {
  const Eigen::VectorXd taken = residual.toward(taken_);
  return std::max(0.0, residual.squares - taken.dot(inverse_ * taken));
}

double ProjectedHypotheses::MisfitOfGivenNoise(const ResidualProducts& residual) const {
  if (space_.variance == 1) return Misfit(residual);
  const Eigen::VectorXd taken = residual.toward(taken_);
  const Eigen::MatrixXd inverse = RegularInverse(space_.model.products()(taken_, taken_),
                                                 InverseSquares(space_.model.priors(), taken_));
  return std::max(0.0, residual.squares - taken.dot(inverse * taken));
}

ResidualProducts ProjectedHypotheses::ProjectAll(const ResidualProducts& residual) const {
  return {Misfit(residual), Project(residual.toward)};
}

Eigen::Index ProjectedHypotheses::Freedom() const {
  const auto without_prior = std::count_if(taken_.begin(), taken_.end(), [&](int column) {
    return !std::isfinite(space_.model.Prior(column).deviation);
  });
  return std::max<Eigen::Index>(1, space_.rows - without_prior);
}

HypothesisSpace ProjectedHypotheses::Marginal() const {
  ResidualProducts residual = ProjectAll({space_.model.squares(), space_.model.toward()});
  Eigen::MatrixXd products = products_;
  for (const int column : taken_) {
    products.row(column).setZero();
    products.col(column).setZero();
  }
  // What remains of an invisible column is rounding.
  for (Eigen::Index k = 0; k < products.cols(); ++k)
    if (products(k, k) == 0) residual.toward[k] = 0;
  HypothesisSpace marginal;
  marginal.model = LinearGaussianModel::FromProducts(residual.squares, std::move(residual.toward),
                                                     std::move(products), space_.model.priors());
  marginal.variance = space_.variance;
  marginal.rows = Freedom();
  marginal.model_error = space_.model_error;
  marginal.hypotheses = space_.hypotheses;
  return marginal;
}

Eigen::VectorXd ProjectedHypotheses::LogBayesFactors(const Eigen::VectorXd& projected) const {
  Eigen::VectorXd factors = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(own_.size()));
  for (size_t h = 0; h < own_.size(); ++h) {
    const Own& own = own_[h];
    const Eigen::Index at = static_cast<Eigen::Index>(h);
    const Eigen::VectorXd toward = projected(space_.hypotheses[h].columns);
    if (IsForce(space_.hypotheses[h]) && !own.taken) factors[at] = LogBayesFactorOfForce(toward);
    if (own.gain.size() == 0) continue;
    factors[at] = toward.dot(own.gain * toward) - own.occam;
    if (own.positive.empty()) continue;
    const Eigen::VectorXd mean = -own.covariance * toward / space_.variance;
    factors[at] += LogOrthantFactor(mean(own.positive), own.covariance(own.positive, own.positive));
  }
  return factors;
}

ProjectedHypotheses::Amounts ProjectedHypotheses::AmountsOf(
    size_t hypothesis, const Eigen::VectorXd& projected) const {
  const Own& own = own_[hypothesis];
  const std::vector<int>& columns = space_.hypotheses[hypothesis].columns;
  Amounts amounts;
  const Eigen::Index size = static_cast<Eigen::Index>(columns.size());
  amounts.value = Eigen::VectorXd::Zero(size);
  amounts.covariance = Eigen::MatrixXd::Zero(size, size);
  if (own.gain.size() == 0) return amounts;
  amounts.covariance = own.covariance;
  amounts.value = PositiveMode(-own.covariance * projected(columns) / space_.variance,
                               own.covariance, own.positive);
  return amounts;
}

}  // namespace lacuna
