#include "fit/calibration.h"

#include <glog/logging.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "fit/bounded_descent.h"
#include "fit/prior_cost.h"

namespace lacuna {
namespace {

// A typical change of a parameter that moves the residual vector by less than this many standard
// deviations cannot be distinguished from no change.
constexpr double kNoticeable = 2;
constexpr double kDead = 1e-6;
// A parameter is at its bound within this share of a typical change, plus of its own value where it
// is fitted on a linear scale.
constexpr double kAtBoundWithin = 1e-6;
// Errors that persist longer cannot be distinguished from motion.
constexpr double kLargestAutocorrelation = 0.9;

// The inverse of a positive semi-definite matrix. Parameters with a component in its null space get
// an infinite variance on the diagonal.
Eigen::MatrixXd GeneralisedCovariance(const Eigen::MatrixXd& information) {
  const Eigen::Index count = information.rows();
  const Eigen::VectorXd scale =
      information.diagonal().cwiseSqrt().cwiseMax(std::numeric_limits<double>::min());
  const Eigen::MatrixXd scaled =
      scale.cwiseInverse().asDiagonal() * information * scale.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Zero(count, count);
  std::vector<char> unbounded(count, 0);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::VectorXd v = eigen.eigenvectors().col(k);
    if (eigen.eigenvalues()[k] > 1e-12) {
      covariance += v * v.transpose() / eigen.eigenvalues()[k];
    } else {
      for (Eigen::Index i = 0; i < count; ++i)
        if (std::abs(v[i]) > 1e-6) unbounded[i] = 1;
    }
  }
  covariance = scale.cwiseInverse().asDiagonal() * covariance * scale.cwiseInverse().asDiagonal();
  for (Eigen::Index i = 0; i < count; ++i)
    if (unbounded[i]) covariance(i, i) = std::numeric_limits<double>::infinity();
  return covariance;
}

// The lag-one autocorrelation of the residual (Calibration::autocorrelation).
double AutocorrelationOf(const ResidualEvaluation& prediction) {
  double product = 0;
  for (size_t row = 0; row < prediction.before.size(); ++row)
    if (prediction.before[row] >= 0)
      product += prediction.residual[static_cast<Eigen::Index>(row)] *
                 prediction.residual[prediction.before[row]];
  return product > 0
             ? std::min(product / prediction.residual.squaredNorm(), kLargestAutocorrelation)
             : 0;
}

// Jᵀ R J − JᵀJ. The row of an earlier frame must precede those of later frames.
Eigen::MatrixXd AddedByAutocorrelation(const Eigen::MatrixXd& J,
                                       const std::vector<Eigen::Index>& before,
                                       double autocorrelation) {
  Eigen::MatrixXd past = Eigen::MatrixXd::Zero(J.rows(), J.cols());  // Σ_{j<i} a^(i−j) J_j
  for (size_t row = 0; row < before.size(); ++row)
    if (before[row] >= 0)
      past.row(static_cast<Eigen::Index>(row)) =
          autocorrelation * (past.row(before[row]) + J.row(before[row]));
  const Eigen::MatrixXd half = J.transpose() * past;
  return half + half.transpose();
}

// H⁻¹ B H⁻¹ = H⁻¹ + H⁻¹ (B − H) H⁻¹ with `more` = B − H. Infinite variances of H⁻¹ are kept.
Eigen::MatrixXd Widened(const Eigen::MatrixXd& covariance, const Eigen::MatrixXd& more) {
  const Eigen::MatrixXd known = covariance.array().isFinite().select(
      covariance, Eigen::MatrixXd::Zero(more.rows(), more.cols()));
  return covariance + known * more * known;
}

// Sets the 95 % interval about a value, for a given standard deviation of φ.
void SetInterval(const CalibratedParameter& parameter, double centre, double deviation,
                 ParameterEstimate* estimate) {
  const double free = ToFree(parameter, centre), reach = kNormalQuantile * deviation;
  estimate->low = std::max(parameter.min, FromFree(parameter, free - reach));
  estimate->high = std::min(parameter.max, FromFree(parameter, free + reach));
}

// Sets the correlation of parameter k with the parameter with which it is correlated most.
// Parameters without influence have none.
void SetCorrelation(const std::vector<CalibratedParameter>& parameters,
                    const Eigen::MatrixXd& information, const Eigen::MatrixXd& covariance,
                    Eigen::Index k, ParameterEstimate* estimate) {
  for (Eigen::Index i = 0; i < covariance.rows(); ++i) {
    const double product = information(i, i) * information(k, k);
    if (i == k || !(product > 0)) continue;
    const double correlation = covariance(i, k) / std::sqrt(covariance(i, i) * covariance(k, k));
    if (std::abs(correlation) > std::abs(estimate->correlation)) {
      estimate->correlation = correlation;
      estimate->traded_with = parameters[i].name;
    }
  }
}

// Whether a value lies on one of the bounds, on the scale on which the parameter is fitted and to
// within the precision of the search.
bool IsAtBound(const CalibratedParameter& parameter, double value) {
  const double free = ToFree(parameter, value);
  const double above_min = parameter.log_scale && parameter.min <= 0
                               ? std::numeric_limits<double>::infinity()
                               : free - ToFree(parameter, parameter.min);
  const double below_max = ToFree(parameter, parameter.max) - free;
  const double close =
      kAtBoundWithin * (parameter.typical + (parameter.log_scale ? 0 : std::abs(value)));
  return above_min < close || below_max < close;
}

// How well the data determine a parameter. `influence`: how far a typical change of it moves the
// residual vector, in standard deviations.
Determination DeterminationOf(const CalibratedParameter& parameter,
                              const ParameterEstimate& estimate, double influence) {
  if (influence < kDead) return Determination::kDead;
  if (IsAtBound(parameter, estimate.value)) return Determination::kAtBound;
  if (influence < kNoticeable) return Determination::kFlat;
  if (kNoticeable * estimate.deviation > parameter.typical) return Determination::kTradedOff;
  return Determination::kPinnedDown;
}

// The information JᵀJ/v of the data plus the precisions of the priors.
Eigen::MatrixXd WithPriors(const std::vector<CalibratedParameter>& parameters,
                           const Eigen::MatrixXd& information, double variance) {
  Eigen::MatrixXd with_prior = information / variance;
  for (Eigen::Index k = 0; k < with_prior.rows(); ++k) {
    const double deviation = parameters[k].prior_deviation;
    if (std::isfinite(deviation)) with_prior(k, k) += 1 / (deviation * deviation);
  }
  return with_prior;
}

// Fills in covariance and estimates at the solution, where J = ∂r/∂φ.
void Estimate(const std::vector<CalibratedParameter>& parameters, const ResidualEvaluation& last,
              const Eigen::MatrixXd& J, Calibration* calibration) {
  const double variance = calibration->inflation * calibration->inflation;
  const Eigen::MatrixXd information = J.transpose() * J;
  const Eigen::MatrixXd more = AddedByAutocorrelation(J, last.before, calibration->autocorrelation);
  const Eigen::MatrixXd data_only = variance * Widened(GeneralisedCovariance(information), more);
  calibration->covariance = Widened(
      GeneralisedCovariance(WithPriors(parameters, information, variance)), more / variance);
  for (Eigen::Index k = 0; k < J.cols(); ++k) {
    const CalibratedParameter& parameter = parameters[k];
    ParameterEstimate estimate;
    estimate.value = calibration->parameters[k];
    estimate.deviation = std::sqrt(data_only(k, k));
    estimate.posterior_deviation = std::sqrt(calibration->covariance(k, k));
    SetInterval(parameter, estimate.value, estimate.posterior_deviation, &estimate);
    SetCorrelation(parameters, information, calibration->covariance, k, &estimate);
    const double influence = J.col(k).norm() * parameter.typical / calibration->inflation;
    estimate.determination = DeterminationOf(parameter, estimate, influence);
    calibration->estimates.push_back(estimate);
  }
}

}  // namespace

void WidenIntervalByModelErrors(const CalibratedParameter& parameter, double centre,
                                double deviation, ParameterEstimate* estimate) {
  SetInterval(parameter, centre, std::hypot(estimate->posterior_deviation, deviation), estimate);
}

double RootMeanSquare(const ResidualEvaluation& prediction) {
  const Eigen::Index observed = prediction.Observed();
  return observed > 0 ? prediction.residual.norm() / std::sqrt(static_cast<double>(observed)) : 0;
}

Calibration Calibrate(const std::vector<CalibratedParameter>& parameters,
                      const ResidualFunction& predict, const CalibrationOptions& options) {
  const int count = static_cast<int>(parameters.size());
  Calibration calibration;
  calibration.parameters.resize(count);
  for (int k = 0; k < count; ++k) {
    const CalibratedParameter& parameter = parameters[k];
    CHECK(parameter.start >= parameter.min && parameter.start <= parameter.max)
        << parameter.name << " starts outside its bounds";
    CHECK(!parameter.log_scale || parameter.start > 0)
        << parameter.name << " cannot start at " << parameter.start << " on a logarithmic scale";
    CHECK_GT(parameter.typical, 0) << parameter.name;
    calibration.parameters[k] = parameter.start;
  }
  ResidualEvaluation last = predict(calibration.parameters, /*with_jacobian=*/count > 0);
  calibration.predictions = 1;
  if (!last.usable) {
    calibration.message = "no prediction at the start: " + last.message;
    return calibration;
  }
  calibration.start_rms = RootMeanSquare(last);
  calibration.cost = 0.5 * last.residual.squaredNorm();
  calibration.usable = true;
  if (count > 0) {
    DescentEnd end = Descend(parameters, options, std::move(last), predict);
    calibration.parameters = std::move(end.parameters);
    calibration.usable = end.usable;
    calibration.message = std::move(end.message);
    calibration.cost = end.cost;
    calibration.iterations = end.iterations;
    calibration.predictions += end.predictions;
    calibration.is_out_of_budget = end.is_out_of_budget;
    last = std::move(end.prediction);
  }
  calibration.rms = RootMeanSquare(last);
  calibration.inflation = std::max(1.0, calibration.rms);
  calibration.autocorrelation = AutocorrelationOf(last);
  if (count > 0) {
    Eigen::MatrixXd J = last.jacobian;
    DeriveByFreeValues(parameters, calibration.parameters, &J);
    Estimate(parameters, last, J, &calibration);
  }
  return calibration;
}

}  // namespace lacuna
