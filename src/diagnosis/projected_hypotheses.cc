#include "diagnosis/projected_hypotheses.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

namespace lacuna {
namespace {

// What remains of a column after a projection is rounding below this share of its square.
constexpr double kRounding = 1e-9;

double LogMeanExp(const std::vector<double>& values) {
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0;
  for (const double value : values) sum += std::exp(value - largest);
  return largest + std::log(sum / static_cast<double>(values.size()));
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
    if (products_(k, k) < kRounding * model.products()(k, k)) {
      products_.row(k).setZero();
      products_.col(k).setZero();
    }
  for (const WeighedHypothesis& hypothesis : space.hypotheses) own_.push_back(Prepare(hypothesis));
  for (const WeighedHypothesis& hypothesis : space.hypotheses) {
    if (hypothesis.kind != HypothesisKind::kUnknownForce) continue;
    const auto decomposed = Eigen::MatrixXd(products_(hypothesis.columns, hypothesis.columns))
                                .completeOrthogonalDecomposition();
    force_inverse_ = decomposed.pseudoInverse();
    force_rank_ = decomposed.rank();
  }
}

double ProjectedHypotheses::ForceMisfit(const Eigen::VectorXd& projected) const {
  for (const WeighedHypothesis& hypothesis : space_.hypotheses) {
    if (hypothesis.kind != HypothesisKind::kUnknownForce) continue;
    const Eigen::VectorXd own = projected(hypothesis.columns);
    return own.dot(force_inverse_ * own) / space_.variance - static_cast<double>(force_rank_);
  }
  return 0;
}

ProjectedHypotheses::Own ProjectedHypotheses::Prepare(const WeighedHypothesis& hypothesis) const {
  Own own;
  const std::vector<int>& columns = hypothesis.columns;
  own.taken = std::any_of(columns.begin(), columns.end(), [&](int column) {
    return std::count(taken_.begin(), taken_.end(), column) > 0;
  });
  if (own.taken || columns.empty()) return own;
  const std::vector<LinearPrior>& priors = space_.model.priors();
  own.positive = columns.size() == 1 && priors[static_cast<size_t>(columns[0])].positive;
  const Eigen::MatrixXd visible = products_(columns, columns);
  const Eigen::Index size = visible.rows();
  const auto add = [&](const Eigen::VectorXd& inverse_prior) {
    Scale scale;
    scale.gain = 0.5 / space_.variance * RegularInverse(visible, space_.variance * inverse_prior);
    const Eigen::VectorXd unit = inverse_prior.cwiseSqrt().cwiseInverse();
    Eigen::MatrixXd spread = unit.asDiagonal() * visible * unit.asDiagonal() / space_.variance;
    spread += Eigen::MatrixXd::Identity(size, size);
    scale.occam = 0.5 * spread.ldlt().vectorD().cwiseMax(1e-300).array().log().sum();
    own.scales.push_back(std::move(scale));
  };
  if (hypothesis.kind == HypothesisKind::kUnknownForce) {
    for (const double scale : kForceScales)
      add(Eigen::VectorXd::Constant(size, 1 / (scale * scale)));
  } else {
    add(InverseSquares(priors, columns));
  }
  return own;
}

Eigen::VectorXd ProjectedHypotheses::Project(const Eigen::VectorXd& toward) const {
  return toward - weights_.transpose() * toward(taken_);
}

double ProjectedHypotheses::Misfit(const ResidualProducts& residual) const {
  const Eigen::VectorXd taken = residual.toward(taken_);
  return std::max(0.0, residual.squares - taken.dot(inverse_ * taken));
}

Eigen::VectorXd ProjectedHypotheses::LogBayesFactors(const Eigen::VectorXd& projected) const {
  Eigen::VectorXd factors = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(own_.size()));
  for (size_t h = 0; h < own_.size(); ++h) {
    const Own& own = own_[h];
    if (own.scales.empty()) continue;
    const Eigen::VectorXd toward = projected(space_.hypotheses[h].columns);
    std::vector<double> gains;
    for (const Scale& scale : own.scales)
      gains.push_back(toward.dot(scale.gain * toward) - scale.occam);
    if (own.positive) {
      const double covariance = 2 * space_.variance * space_.variance * own.scales[0].gain(0, 0);
      const double value = -covariance * toward[0] / space_.variance;
      gains[0] += LogTwiceNormal(value / std::sqrt(covariance));
    }
    factors[static_cast<Eigen::Index>(h)] = LogMeanExp(gains);
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
  if (own.scales.empty()) return amounts;
  amounts.covariance = 2 * space_.variance * space_.variance * own.scales.front().gain;
  amounts.value = -amounts.covariance * projected(columns) / space_.variance;
  if (own.positive) amounts.value = amounts.value.cwiseMax(0);
  return amounts;
}

}  // namespace lacuna
