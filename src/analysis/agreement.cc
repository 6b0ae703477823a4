#include "analysis/agreement.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/whiteness.h"

namespace lacuna {
namespace {

// A prior so wide that it changes no estimate, in typical changes: it makes the equations solvable
// where a recording does not determine a parameter.
constexpr double kWide = 1e3;

// The equations of all unknowns: the parameters of each recording, its own amounts, and at the end
// the shared ones.
struct Equations {
  Eigen::MatrixXd precision;
  Eigen::VectorXd right;  // precision · mean = right

  explicit Equations(Eigen::Index size)
      : precision(Eigen::MatrixXd::Zero(size, size)), right(Eigen::VectorXd::Zero(size)) {}

  void AddPrior(Eigen::Index at, const LinearPrior& prior) {
    if (!std::isfinite(prior.deviation)) return;
    const double weight = 1 / (prior.deviation * prior.deviation);
    precision(at, at) += weight;
    right[at] += weight * prior.mean;
  }
};

// Adds the rows, whose columns belong to these unknowns.
void AddRows(const Eigen::VectorXd& residual, const Eigen::MatrixXd& columns,
             const std::vector<Eigen::Index>& unknowns, double variance, Equations* equations) {
  equations->precision(unknowns, unknowns) += columns.transpose() * columns / variance;
  equations->right(unknowns) -= columns.transpose() * residual / variance;
}

Eigen::MatrixXd Inverse(const Eigen::MatrixXd& symmetric) {
  // Scaled to a unit diagonal: unknowns have different units.
  const Eigen::VectorXd scale = symmetric.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * symmetric * scale.asDiagonal();
  const Eigen::MatrixXd inverse =
      scaled.ldlt().solve(Eigen::MatrixXd::Identity(scaled.rows(), scaled.cols()));
  return scale.asDiagonal() * inverse * scale.asDiagonal();
}

// The χ² of the direction `along` of the differences, with one degree of freedom.
double SquareAlong(const Eigen::VectorXd& along, const Eigen::MatrixXd& information,
                   const Eigen::VectorXd& score) {
  const double known = along.dot(information * along);
  return known > 0 ? std::pow(along.dot(score), 2) / known : 0;
}

}  // namespace

AgreementTest TestAgreement(const std::vector<RecordingRows>& recordings,
                            const std::vector<LinearPrior>& shared_priors,
                            const Eigen::VectorXd& typical, double variance) {
  const Eigen::Index count = static_cast<Eigen::Index>(recordings.size());
  const Eigen::Index p = typical.size();
  const Eigen::Index shared = static_cast<Eigen::Index>(shared_priors.size());
  CHECK_GE(count, 2);
  Eigen::Index size = count * p + shared;
  for (const RecordingRows& rows : recordings) size += rows.own.cols();

  Equations equations(size);
  for (Eigen::Index k = 0; k < shared; ++k)
    equations.AddPrior(size - shared + k, shared_priors[static_cast<size_t>(k)]);
  Eigen::Index own = count * p;
  for (Eigen::Index i = 0; i < count; ++i) {
    const RecordingRows& rows = recordings[static_cast<size_t>(i)];
    CHECK_EQ(rows.parameters.cols(), p);
    CHECK_EQ(rows.shared.cols(), shared);
    CHECK_EQ(rows.own.cols(), static_cast<Eigen::Index>(rows.own_priors.size()));
    std::vector<Eigen::Index> unknowns;
    for (Eigen::Index k = 0; k < p; ++k) {
      unknowns.push_back(i * p + k);
      equations.AddPrior(unknowns.back(), {0, kWide * typical[k], false});
    }
    for (const LinearPrior& prior : rows.own_priors) {
      equations.AddPrior(own, prior);
      unknowns.push_back(own++);
    }
    for (Eigen::Index k = 0; k < shared; ++k) unknowns.push_back(size - shared + k);
    Eigen::MatrixXd columns(rows.residual.size(), static_cast<Eigen::Index>(unknowns.size()));
    columns << rows.parameters, rows.own, rows.shared;
    AddRows(rows.residual, columns, unknowns, variance, &equations);
  }
  const Eigen::MatrixXd covariance = Inverse(equations.precision);
  const Eigen::VectorXd mean = covariance * equations.right;

  AgreementTest test;
  test.change = mean.head(count * p).reshaped(p, count);
  test.deviation = covariance.diagonal().head(count * p).cwiseSqrt().reshaped(p, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index k = 0; k < p; ++k)
      if (test.deviation(k, i) > typical[k])
        test.deviation(k, i) = std::numeric_limits<double>::infinity();

  // The differences from the last recording, in typical changes.
  const Eigen::Index differences = (count - 1) * p;
  Eigen::MatrixXd contrast = Eigen::MatrixXd::Zero(differences, count * p);
  for (Eigen::Index row = 0; row < differences; ++row) {
    const Eigen::Index k = row % p;
    contrast(row, row) = 1 / typical[k];
    contrast(row, differences + k) = -1 / typical[k];
  }
  const Eigen::VectorXd apart = contrast * mean.head(count * p);
  const Eigen::MatrixXd of_apart =
      contrast * covariance.topLeftCorner(count * p, count * p) * contrast.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(of_apart);
  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(differences, differences);
  // A smaller variance than the rounding of the largest one is not known, and may be negative.
  const double least = std::numeric_limits<double>::epsilon() * static_cast<double>(differences) *
                       eigen.eigenvalues().cwiseAbs().maxCoeff();
  for (Eigen::Index k = 0; k < differences; ++k) {
    const double spread = std::max(eigen.eigenvalues()[k], least);
    const Eigen::VectorXd direction = eigen.eigenvectors().col(k);
    if (spread >= 1) continue;
    information += direction * direction.transpose() / spread;
    test.chi_square += std::pow(direction.dot(apart), 2) / spread;
    ++test.degrees_of_freedom;
  }
  if (test.degrees_of_freedom > 0)
    test.p_value = ChiSquareTail(test.chi_square, test.degrees_of_freedom);

  const Eigen::VectorXd score = information * apart;
  test.p_values = Eigen::VectorXd::Ones(p);
  test.odd = Eigen::MatrixXd::Zero(p, count);
  for (Eigen::Index k = 0; k < p; ++k) {
    std::vector<Eigen::Index> of_parameter;
    for (Eigen::Index i = 0; i + 1 < count; ++i) of_parameter.push_back(i * p + k);
    Eigen::VectorXd all = Eigen::VectorXd::Zero(differences);
    for (Eigen::Index i = 0; i + 1 < count; ++i) {
      const Eigen::VectorXd one = Eigen::VectorXd::Unit(differences, i * p + k);
      all += one;
      test.odd(k, i) = SquareAlong(one, information, score);
    }
    test.odd(k, count - 1) = SquareAlong(all, information, score);
    const Eigen::MatrixXd known = information(of_parameter, of_parameter);
    const Eigen::VectorXd own_score = score(of_parameter);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> own_eigen(known);
    double chi_square = 0;
    int freedom = 0;
    for (Eigen::Index a = 0; a < known.rows(); ++a) {
      if (own_eigen.eigenvalues()[a] <= 1) continue;
      chi_square +=
          std::pow(own_eigen.eigenvectors().col(a).dot(own_score), 2) / own_eigen.eigenvalues()[a];
      ++freedom;
    }
    if (freedom > 0) test.p_values[k] = ChiSquareTail(chi_square, freedom);
  }
  return test;
}

}  // namespace lacuna
