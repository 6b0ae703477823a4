#include "analysis/linear_evidence.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/non_negative_minimum.h"
#include "analysis/normal_distribution.h"

namespace lacuna {
namespace {

// After a projection, less than this fraction of a column's square consists of rounding errors.
constexpr double kRounding = 1e-8;

// The posterior information matrix of the chosen parameters, scaled to a unit diagonal.
struct ScaledInformation {
  // Its inverse times the columns.
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& columns) const {
    return unit.asDiagonal() * factor.solve(unit.asDiagonal() * columns);
  }

  Eigen::VectorXd unit;
  Eigen::LDLT<Eigen::MatrixXd> factor;
};

ScaledInformation Informed(const Eigen::MatrixXd& products, const std::vector<LinearPrior>& priors,
                           const std::vector<int>& chosen, double variance) {
  Eigen::MatrixXd information = products(chosen, chosen) / variance;
  for (size_t i = 0; i < chosen.size(); ++i) {
    const double deviation = priors[chosen[i]].deviation;
    const Eigen::Index k = static_cast<Eigen::Index>(i);
    if (std::isfinite(deviation)) information(k, k) += 1 / (deviation * deviation);
    // Keeps the matrix regular for a parameter without influence and without prior.
    information(k, k) = std::max(information(k, k), std::numeric_limits<double>::min());
  }
  ScaledInformation scaled;
  scaled.unit = information.diagonal().cwiseSqrt().cwiseInverse();
  scaled.factor.compute(scaled.unit.asDiagonal() * information * scaled.unit.asDiagonal());
  return scaled;
}

// The normal posterior of the changes of these columns, the others being 0.
struct Posterior {
  ScaledInformation information;
  Eigen::VectorXd right;  // the information matrix times the mean
  Eigen::VectorXd mean;
};

Posterior PosteriorOf(const LinearGaussianModel& model, const std::vector<int>& columns,
                      double variance) {
  Posterior posterior;
  posterior.information = Informed(model.products(), model.priors(), columns, variance);
  posterior.right = -model.toward()(columns) / variance;
  for (size_t k = 0; k < columns.size(); ++k) {
    const LinearPrior& prior = model.Prior(columns[k]);
    if (std::isfinite(prior.deviation))
      posterior.right[static_cast<Eigen::Index>(k)] +=
          prior.mean / (prior.deviation * prior.deviation);
  }
  posterior.mean = posterior.information.Solve(posterior.right);
  return posterior;
}

// ‖r + A δ‖²
double MisfitAt(const LinearGaussianModel& model, const std::vector<int>& columns,
                const Eigen::VectorXd& change) {
  return std::max(0.0, model.squares() + 2 * change.dot(model.toward()(columns)) +
                           change.dot(model.products()(columns, columns) * change));
}

// The log evidence with the priors truncated at 0 where they must be positive. `all`: the posterior
// of all chosen columns without a restriction; `deviation`: of its changes.
double LogEvidence(const LinearGaussianModel& model, const std::vector<int>& chosen,
                   double variance, const Posterior& all, const Eigen::VectorXd& deviation) {
  double truncation = 0, prior_cost = 0, log_prior = 0;
  for (size_t i = 0; i < chosen.size(); ++i) {
    const LinearPrior& prior = model.Prior(chosen[i]);
    const Eigen::Index k = static_cast<Eigen::Index>(i);
    if (prior.positive && deviation[k] > 0)
      truncation += LogTwiceNormal(all.mean[k] / deviation[k]);
    if (!std::isfinite(prior.deviation)) continue;
    prior_cost += std::pow((all.mean[k] - prior.mean) / prior.deviation, 2);
    log_prior += std::log(prior.deviation);
  }
  const ScaledInformation& information = all.information;
  const double log_determinant = information.factor.vectorD().array().max(1e-300).log().sum() -
                                 2 * information.unit.array().log().sum();
  const double misfit = MisfitAt(model, chosen, all.mean);
  return -0.5 * (misfit / variance + prior_cost) - 0.5 * log_determinant - log_prior + truncation;
}

// Places within a list of chosen columns.
using Places = std::vector<Eigen::Index>;

std::vector<int> ColumnsAt(const Places& places, const std::vector<int>& chosen) {
  std::vector<int> columns;
  for (const Eigen::Index place : places) columns.push_back(chosen[static_cast<size_t>(place)]);
  return columns;
}

// The places of `count` columns but for `zeros`, which are in ascending order.
Places PlacesBut(const Places& zeros, Eigen::Index count) {
  Places free;
  for (Eigen::Index place = 0; place < count; ++place)
    if (!std::binary_search(zeros.begin(), zeros.end(), place)) free.push_back(place);
  return free;
}

// The changes of the chosen columns where the posterior is densest among those that are not
// negative where they must be positive. `all`: the posterior without that restriction.
NonNegativeMinimum ModeOf(const LinearGaussianModel& model, const std::vector<int>& chosen,
                          double variance, const Posterior& all) {
  const Eigen::Index count = all.mean.size();
  // Of half the square of the distance from the mean, in terms of the information matrix.
  const auto minimize = [&](const Places& zeros) -> MinimumWithZeros {
    if (zeros.empty()) return {all.mean, {}, -0.5 * all.right.dot(all.mean)};
    const Places free = PlacesBut(zeros, count);
    const std::vector<int> columns = ColumnsAt(free, chosen), held = ColumnsAt(zeros, chosen);
    const Posterior posterior = PosteriorOf(model, columns, variance);
    MinimumWithZeros minimum;
    minimum.at = Eigen::VectorXd::Zero(count);
    for (size_t k = 0; k < free.size(); ++k)
      minimum.at[free[k]] = posterior.mean[static_cast<Eigen::Index>(k)];
    const Eigen::VectorXd slopes =
        model.products()(held, columns) * posterior.mean / variance - all.right(zeros);
    minimum.slopes = slopes.cwiseProduct(all.information.unit(zeros));
    minimum.value = -0.5 * posterior.right.dot(posterior.mean);
    return minimum;
  };
  Places positive;
  for (Eigen::Index place = 0; place < count; ++place)
    if (model.Prior(chosen[static_cast<size_t>(place)]).positive) positive.push_back(place);
  return MinimizeNonNegative(minimize, positive);
}

}  // namespace

double LogMeanExp(const std::vector<double>& values) {
  const double largest = *std::max_element(values.begin(), values.end());
  double sum = 0;
  for (const double value : values) sum += std::exp(value - largest);
  return largest + std::log(sum / static_cast<double>(values.size()));
}

void AppendColumns(const Eigen::MatrixXd& more, const std::vector<LinearPrior>& more_priors,
                   Eigen::MatrixXd* columns, std::vector<LinearPrior>* priors) {
  CHECK_EQ(more.cols(), static_cast<Eigen::Index>(more_priors.size()));
  CHECK_EQ(columns->cols(), static_cast<Eigen::Index>(priors->size()));
  const Eigen::Index before = columns->cols();
  if (columns->rows() == 0 && before == 0) columns->resize(more.rows(), 0);
  if (more.cols() == 0) return;
  CHECK_EQ(more.rows(), columns->rows());
  columns->conservativeResize(Eigen::NoChange, before + more.cols());
  columns->rightCols(more.cols()) = more;
  priors->insert(priors->end(), more_priors.begin(), more_priors.end());
}

LinearGaussianModel::LinearGaussianModel(const Eigen::VectorXd& residual,
                                         const Eigen::MatrixXd& columns,
                                         std::vector<LinearPrior> priors)
    : squares_(residual.squaredNorm()),
      toward_(columns.transpose() * residual),
      products_(columns.transpose() * columns),
      priors_(std::move(priors)) {
  CHECK_EQ(columns.rows(), residual.size());
  CHECK_EQ(columns.cols(), static_cast<Eigen::Index>(priors_.size()));
  for (const LinearPrior& prior : priors_) CHECK_GT(prior.deviation, 0);
}

LinearGaussianModel LinearGaussianModel::FromProducts(double squares, Eigen::VectorXd toward,
                                                      Eigen::MatrixXd products,
                                                      std::vector<LinearPrior> priors) {
  CHECK_EQ(toward.size(), static_cast<Eigen::Index>(priors.size()));
  CHECK_EQ(products.rows(), toward.size());
  CHECK_EQ(products.cols(), toward.size());
  LinearGaussianModel model;
  model.squares_ = squares;
  model.toward_ = std::move(toward);
  model.products_ = std::move(products);
  model.priors_ = std::move(priors);
  return model;
}

LinearGaussianModel LinearGaussianModel::WithResidual(const Eigen::VectorXd& residual,
                                                      const Eigen::MatrixXd& columns) const {
  CHECK_EQ(columns.cols(), products_.cols());
  LinearGaussianModel other = *this;
  other.squares_ = residual.squaredNorm();
  other.toward_ = columns.transpose() * residual;
  return other;
}

LinearFit LinearGaussianModel::FitAll(double variance) const {
  std::vector<int> all(priors_.size());
  std::iota(all.begin(), all.end(), 0);
  return Fit(all, variance);
}

LinearFit LinearGaussianModel::Fit(const std::vector<int>& chosen, double variance) const {
  CHECK_GT(variance, 0);
  const Eigen::Index count = static_cast<Eigen::Index>(chosen.size());
  const Posterior all = PosteriorOf(*this, chosen, variance);
  const Eigen::MatrixXd covariance = all.information.Solve(Eigen::MatrixXd::Identity(count, count));
  LinearFit fit;
  fit.deviation = covariance.diagonal().cwiseMax(0).cwiseSqrt();
  fit.log_evidence = LogEvidence(*this, chosen, variance, all, fit.deviation);
  const NonNegativeMinimum mode = ModeOf(*this, chosen, variance, all);
  fit.change = mode.at;
  const Places free = PlacesBut(mode.zeros, count);
  fit.misfit = MisfitAt(*this, ColumnsAt(free, chosen), mode.at(free));
  return fit;
}

Eigen::MatrixXd LinearGaussianModel::Remaining(const std::vector<int>& taken,
                                               const std::vector<int>& a, const std::vector<int>& b,
                                               double variance) const {
  Eigen::MatrixXd remaining = products_(a, b);
  if (taken.empty()) return remaining;
  const ScaledInformation information = Informed(products_, priors_, taken, variance);
  const Eigen::MatrixXd from = information.unit.asDiagonal() * products_(taken, a);
  const Eigen::MatrixXd to = information.unit.asDiagonal() * products_(taken, b);
  remaining -= from.transpose() * information.factor.solve(to) / variance;
  return remaining;
}

double LinearGaussianModel::Collinearity(const std::vector<int>& taken, const std::vector<int>& a,
                                         const std::vector<int>& b, double variance) const {
  const auto whitener = [&](const std::vector<int>& columns) {
    const Eigen::VectorXd unit =
        products_(columns, columns).diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
    const Eigen::MatrixXd gram =
        unit.asDiagonal() * Remaining(taken, columns, columns, variance) * unit.asDiagonal();
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(
        Eigen::MatrixXd(0.5 * (gram + gram.transpose())));
    Eigen::MatrixXd inverse_root = Eigen::MatrixXd::Zero(gram.rows(), gram.cols());
    for (Eigen::Index k = 0; k < gram.rows(); ++k) {
      const double value = eigen.eigenvalues()[k];
      if (value > kRounding)
        inverse_root.col(k) = unit.asDiagonal() * eigen.eigenvectors().col(k) / std::sqrt(value);
    }
    return inverse_root;
  };
  const Eigen::MatrixXd cross =
      whitener(a).transpose() * Remaining(taken, a, b, variance) * whitener(b);
  return std::min(1.0, cross.jacobiSvd().singularValues()[0]);
}

}  // namespace lacuna
