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

// The equations of all recordings: p parameters for each, its own amounts, and the shared ones.
Equations AssembleEquations(const std::vector<RecordingRows>& recordings,
                            const std::vector<LinearPrior>& shared_priors,
                            const Eigen::VectorXd& typical, double variance) {
  const Eigen::Index count = static_cast<Eigen::Index>(recordings.size());
  const Eigen::Index p = typical.size();
  const Eigen::Index shared = static_cast<Eigen::Index>(shared_priors.size());
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
  return equations;
}

// The matrix that takes the parameters of all recordings to their differences from the last
// recording, in typical changes: (R − 1)p × Rp.
Eigen::MatrixXd DifferencesFromLast(Eigen::Index recordings, const Eigen::VectorXd& typical) {
  const Eigen::Index p = typical.size();
  const Eigen::Index differences = (recordings - 1) * p;
  Eigen::MatrixXd contrast = Eigen::MatrixXd::Zero(differences, recordings * p);
  for (Eigen::Index row = 0; row < differences; ++row) {
    const Eigen::Index k = row % p;
    contrast(row, row) = 1 / typical[k];
    contrast(row, differences + k) = -1 / typical[k];
  }
  return contrast;
}

// The eigenvectors of a symmetric matrix along which the recordings determine the differences
// better than a typical change.
struct DeterminedDirections {
  std::vector<Eigen::VectorXd> vectors;
  std::vector<double> eigenvalues;

  int Count() const { return static_cast<int>(vectors.size()); }
  // The quadratic form of the inverse of the matrix, restricted to these directions.
  double ChiSquareOf(const Eigen::VectorXd& at) const {
    double sum = 0;
    for (size_t k = 0; k < vectors.size(); ++k)
      sum += std::pow(vectors[k].dot(at), 2) / eigenvalues[k];
    return sum;
  }
};

// The directions that a covariance of differences, in typical changes, determines: those whose
// variance is below 1.
DeterminedDirections DeterminedByCovariance(const Eigen::MatrixXd& covariance) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(covariance);
  // A smaller variance than the rounding of the largest one is not known, and may be negative.
  const double least = std::numeric_limits<double>::epsilon() *
                       static_cast<double>(covariance.rows()) *
                       eigen.eigenvalues().cwiseAbs().maxCoeff();
  DeterminedDirections determined;
  for (Eigen::Index k = 0; k < covariance.rows(); ++k) {
    const double variance = std::max(eigen.eigenvalues()[k], least);
    if (variance >= 1) continue;
    determined.vectors.emplace_back(eigen.eigenvectors().col(k));
    determined.eigenvalues.push_back(variance);
  }
  return determined;
}

// The directions that an information matrix, the inverse of a covariance, determines: those whose
// information is above 1.
DeterminedDirections DeterminedByInformation(const Eigen::MatrixXd& information) {
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(information);
  DeterminedDirections determined;
  for (Eigen::Index k = 0; k < information.rows(); ++k) {
    if (eigen.eigenvalues()[k] <= 1) continue;
    determined.vectors.emplace_back(eigen.eigenvectors().col(k));
    determined.eigenvalues.push_back(eigen.eigenvalues()[k]);
  }
  return determined;
}

// The χ² of the direction `along` of the differences, with one degree of freedom.
double SquareAlong(const Eigen::VectorXd& along, const Eigen::MatrixXd& information,
                   const Eigen::VectorXd& score) {
  const double known = along.dot(information * along);
  return known > 0 ? std::pow(along.dot(score), 2) / known : 0;
}

// What an error of the model of this length may leave of a χ².
double Beyond(double model_error, double chi_square) {
  return std::pow(std::max(0.0, std::sqrt(chi_square) - model_error), 2);
}

// Fills in what the test says of one parameter, with the information M and the score s of all
// differences.
void JudgeParameter(Eigen::Index parameter, const Eigen::MatrixXd& information,
                    const Eigen::VectorXd& score, double model_error, AgreementTest* test) {
  const Eigen::Index p = test->change.rows(), count = test->change.cols();
  std::vector<Eigen::Index> of_parameter;
  for (Eigen::Index i = 0; i + 1 < count; ++i) of_parameter.push_back(i * p + parameter);
  Eigen::VectorXd all = Eigen::VectorXd::Zero(score.size());
  for (Eigen::Index i = 0; i + 1 < count; ++i) {
    const Eigen::VectorXd one = Eigen::VectorXd::Unit(score.size(), i * p + parameter);
    all += one;
    test->odd(parameter, i) = SquareAlong(one, information, score);
  }
  test->odd(parameter, count - 1) = SquareAlong(all, information, score);
  const DeterminedDirections own = DeterminedByInformation(information(of_parameter, of_parameter));
  if (own.Count() > 0)
    test->p_values[parameter] =
        ChiSquareTail(Beyond(model_error, own.ChiSquareOf(score(of_parameter))), own.Count());
}

}  // namespace

AgreementTest TestAgreement(const std::vector<RecordingRows>& recordings,
                            const std::vector<LinearPrior>& shared_priors,
                            const Eigen::VectorXd& typical, double variance, double model_error) {
  const Eigen::Index count = static_cast<Eigen::Index>(recordings.size());
  const Eigen::Index p = typical.size();
  CHECK_GE(count, 2);
  const Equations equations = AssembleEquations(recordings, shared_priors, typical, variance);
  const Eigen::MatrixXd covariance = Inverse(equations.precision);
  const Eigen::VectorXd mean = covariance * equations.right;

  AgreementTest test;
  test.change = mean.head(count * p).reshaped(p, count);
  test.deviation = covariance.diagonal().head(count * p).cwiseSqrt().reshaped(p, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index k = 0; k < p; ++k)
      if (test.deviation(k, i) > typical[k])
        test.deviation(k, i) = std::numeric_limits<double>::infinity();

  const Eigen::MatrixXd contrast = DifferencesFromLast(count, typical);
  const Eigen::VectorXd differences = contrast * mean.head(count * p);
  const DeterminedDirections determined = DeterminedByCovariance(
      contrast * covariance.topLeftCorner(count * p, count * p) * contrast.transpose());
  test.chi_square = Beyond(model_error, determined.ChiSquareOf(differences));
  test.degrees_of_freedom = determined.Count();
  if (test.degrees_of_freedom > 0)
    test.p_value = ChiSquareTail(test.chi_square, test.degrees_of_freedom);

  Eigen::MatrixXd information = Eigen::MatrixXd::Zero(differences.size(), differences.size());
  for (size_t k = 0; k < determined.vectors.size(); ++k) {
    const Eigen::VectorXd& direction = determined.vectors[k];
    information += direction * direction.transpose() / determined.eigenvalues[k];
  }
  const Eigen::VectorXd score = information * differences;
  test.p_values = Eigen::VectorXd::Ones(p);
  test.odd = Eigen::MatrixXd::Zero(p, count);
  for (Eigen::Index k = 0; k < p; ++k) JudgeParameter(k, information, score, model_error, &test);
  return test;
}

}  // namespace lacuna
