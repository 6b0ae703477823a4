#include "analysis/linear_evidence.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace lacuna {
namespace {

// After a projection, less than this fraction of a column's square consists of rounding errors.
constexpr double kRounding = 1e-8;

// The posterior information matrix of the chosen parameters, scaled to a unit diagonal.
struct ScaledInformation {
  Eigen::VectorXd unit;
  Eigen::LDLT<Eigen::MatrixXd> factor;
};

}  // namespace

double LogTwiceNormal(double z) {
  if (z > -30) return std::log(std::erfc(-z / std::sqrt(2.0)));
  // An asymptotic series where erfc underflows.
  return -0.5 * z * z - std::log(-z * std::sqrt(0.5 * std::numbers::pi));
}

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

namespace {

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

}  // namespace

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
  LinearFit fit;
  std::vector<int> free = chosen;
  double truncation = 0;  // change of the log-evidence by truncating priors at 0
  bool first = true;
  while (true) {
    const Eigen::Index count = static_cast<Eigen::Index>(free.size());
    const ScaledInformation information = Informed(products_, priors_, free, variance);
    Eigen::VectorXd right = -toward_(free) / variance;
    for (Eigen::Index k = 0; k < count; ++k) {
      const LinearPrior& prior = priors_[free[k]];
      if (std::isfinite(prior.deviation))
        right[k] += prior.mean / (prior.deviation * prior.deviation);
    }
    const auto solve = [&](const Eigen::MatrixXd& columns) -> Eigen::MatrixXd {
      return information.unit.asDiagonal() *
             information.factor.solve(information.unit.asDiagonal() * columns);
    };
    const Eigen::VectorXd change = solve(right);
    const Eigen::MatrixXd covariance = solve(Eigen::MatrixXd::Identity(count, count));
    const double misfit = std::max(
        0.0, squares_ + 2 * change.dot(toward_(free)) + change.dot(products_(free, free) * change));
    if (first) {
      first = false;
      double prior_cost = 0, log_prior = 0;
      for (Eigen::Index k = 0; k < count; ++k) {
        const LinearPrior& prior = priors_[free[k]];
        const double deviation = std::sqrt(std::max(0.0, covariance(k, k)));
        if (prior.positive && deviation > 0) truncation += LogTwiceNormal(change[k] / deviation);
        if (!std::isfinite(prior.deviation)) continue;
        prior_cost += std::pow((change[k] - prior.mean) / prior.deviation, 2);
        log_prior += std::log(prior.deviation);
      }
      const double log_determinant = information.factor.vectorD().array().max(1e-300).log().sum() -
                                     2 * information.unit.array().log().sum();
      fit.log_evidence =
          -0.5 * (misfit / variance + prior_cost) - 0.5 * log_determinant - log_prior + truncation;
      fit.change = Eigen::VectorXd::Zero(count);
      fit.deviation = covariance.diagonal().cwiseMax(0).cwiseSqrt();
    }
    std::vector<int> kept;
    for (Eigen::Index k = 0; k < count; ++k)
      if (!priors_[free[k]].positive || change[k] >= 0) kept.push_back(free[k]);
    if (kept.size() == free.size()) {
      fit.misfit = misfit;
      for (Eigen::Index k = 0; k < count; ++k) {
        const auto place = std::find(chosen.begin(), chosen.end(), free[k]) - chosen.begin();
        fit.change[place] = change[k];
      }
      return fit;
    }
    free = std::move(kept);
  }
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
