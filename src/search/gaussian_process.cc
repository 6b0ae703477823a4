#include "search/gaussian_process.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "search/cobyla.h"
#include "search/ordered_algebra.h"

namespace lacuna {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

// The kernel k as a function of the squared distance between two points whose coordinates have been
// divided by the length scales.
double Matern(double squared) {
  const double r = std::sqrt(5 * squared);
  return (1 + r + r * r / 3) * std::exp(-r);
}

double SquaredDistance(const double* a, const double* b, int n) {
  double sum = 0;
  for (int i = 0; i < n; ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return sum;
}

// Overwrites the upper triangle of `u` with the transposed Cholesky factor: column j becomes row j
// of L. Returns false if the matrix is not positive definite.
bool FactorInPlace(MatrixXd* u) {
  const int size = static_cast<int>(u->rows());
  for (int j = 0; j < size; ++j) {
    double* column = u->col(j).data();
    for (int i = 0; i <= j; ++i) {
      const double* other = u->col(i).data();
      double sum = column[i];
      for (int k = 0; k < i; ++k) sum -= column[k] * other[k];
      if (i < j) {
        column[i] = sum / other[i];
      } else {
        if (!(sum > 0)) return false;
        column[i] = std::sqrt(sum);
      }
    }
  }
  return true;
}

// Returns L⁻¹ b, where L is the transpose of `u`.
VectorXd SolveLower(const MatrixXd& u, VectorXd b) {
  for (int j = 0; j < b.size(); ++j) {
    const double* column = u.col(j).data();
    double sum = b[j];
    for (int k = 0; k < j; ++k) sum -= column[k] * b[k];
    b[j] = sum / column[j];
  }
  return b;
}

}  // namespace

GaussianProcess::GaussianProcess(const MatrixXd& points, const VectorXd& values,
                                 const GaussianProcessScales& scales) {
  const int n = static_cast<int>(points.rows());
  const int count = static_cast<int>(points.cols());
  inverse_lengths_.resize(n);
  for (int i = 0; i < n; ++i) inverse_lengths_[i] = std::exp(-scales.log_lengths[i]);
  points_ = inverse_lengths_.asDiagonal() * points;
  factor_.resize(count, count);
  for (int j = 0; j < count; ++j) {
    for (int i = 0; i < j; ++i) {
      factor_(i, j) = Matern(SquaredDistance(points_.col(i).data(), points_.col(j).data(), n));
    }
    factor_(j, j) = 1 + std::exp(scales.log_noise);
  }
  if (!FactorInPlace(&factor_)) {
    log_likelihood_ = -std::numeric_limits<double>::infinity();
    return;
  }
  weights_ = SolveLower(factor_, values);
  variance_ = std::max(OrderedDot(weights_, weights_) / count, 1e-300);
  log_likelihood_ = -0.5 * count * std::log(variance_);
  for (int j = 0; j < count; ++j) log_likelihood_ -= std::log(factor_(j, j));
}

VectorXd GaussianProcess::Covariances(const VectorXd& x) const {
  const VectorXd scaled = inverse_lengths_.cwiseProduct(x);
  VectorXd covariances(points_.cols());
  for (int j = 0; j < points_.cols(); ++j) {
    covariances[j] = Matern(
        SquaredDistance(points_.col(j).data(), scaled.data(), static_cast<int>(scaled.size())));
  }
  return covariances;
}

GaussianProcess::Prediction GaussianProcess::At(const VectorXd& x) const {
  const VectorXd half = SolveLower(factor_, Covariances(x));
  Prediction prediction;
  prediction.mean = OrderedDot(half, weights_);
  prediction.deviation = std::sqrt(variance_ * std::max(0.0, 1 - OrderedDot(half, half)));
  return prediction;
}

GaussianProcessScales FitScales(const MatrixXd& points, const VectorXd& values,
                                const GaussianProcessScales& first, int evaluations) {
  const int n = static_cast<int>(points.rows());
  const auto unpack = [n](const VectorXd& z) { return GaussianProcessScales{z.head(n), z[n]}; };
  SearchProblem problem;
  problem.lower = VectorXd::Constant(n + 1, std::log(0.05));
  problem.upper = VectorXd::Constant(n + 1, std::log(10.0));
  problem.lower[n] = std::log(1e-8);
  problem.upper[n] = 0;
  problem.start.resize(n + 1);
  problem.start << first.log_lengths, first.log_noise;
  problem.start = problem.start.cwiseMax(problem.lower).cwiseMin(problem.upper);
  problem.evaluate = [&](const VectorXd& z) {
    Evaluation outcome;
    double penalty = 0;
    for (int i = 0; i < n; ++i) {
      const double off = z[i] - std::log(0.5);
      penalty += 0.5 * off * off;
    }
    outcome.value = penalty - GaussianProcess(points, values, unpack(z)).LogLikelihood();
    return outcome;
  };
  SearchControl control;
  control.max_evaluations = evaluations;
  CobylaOptions options;
  options.initial_radius = 0.5;
  options.final_radius = 0.02;
  const SearchResult result = MinimiseByCobyla(problem, control, options);
  return result.IsUsable() ? unpack(result.x()) : first;
}

}  // namespace lacuna
