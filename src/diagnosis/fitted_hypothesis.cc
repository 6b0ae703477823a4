#include "diagnosis/fitted_hypothesis.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/positive_normal.h"
#include "fit/active_bounds.h"

namespace lacuna {
namespace {

// Settle() makes at most so many Gauss–Newton steps, shortens a step that does not help
// by this factor, and stops when the next step would gain less log evidence than this.
constexpr int kSettlingSteps = 5;
constexpr double kStepReduction = 0.3;
constexpr double kSettledGain = 0.5;

std::vector<LinearPrior> WithoutMeans(std::vector<LinearPrior> priors) {
  for (LinearPrior& prior : priors) {
    prior.mean = 0;
    prior.positive = false;
  }
  return priors;
}

// FittedHypothesis::positive of a problem with these parameters.
std::vector<int> PositiveAmounts(const std::vector<CalibratedParameter>& parameters) {
  std::vector<int> positive;
  for (size_t k = 0; k < parameters.size(); ++k) {
    const CalibratedParameter& parameter = parameters[k];
    if (!parameter.log_scale && std::isfinite(parameter.prior_deviation) &&
        parameter.min >= PriorMeanOf(parameter))
      positive.push_back(static_cast<int>(k));
  }
  return positive;
}

// The logarithm of the factor by which truncated priors of the amounts that must be positive change
// the evidence. `model`: of the whitened columns of the hypothesis. The covariance of the amounts
// is v (S + v Q⁻¹)⁻¹, where S are their products after all other columns have been projected out
// and Q is the covariance of their priors.
double LogTruncation(const FittedHypothesis& hypothesis, const LinearGaussianModel& model,
                     double variance) {
  const std::vector<int>& positive = hypothesis.positive;
  if (positive.empty()) return 0;
  std::vector<int> others;
  for (int k = 0; k < static_cast<int>(hypothesis.priors.size()); ++k)
    if (std::count(positive.begin(), positive.end(), k) == 0) others.push_back(k);
  Eigen::MatrixXd information = model.Remaining(others, positive, positive, variance) / variance;
  const Eigen::Index count = information.rows();
  Eigen::VectorXd amounts(count), deviations(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const LinearPrior& prior = hypothesis.priors[static_cast<size_t>(positive[k])];
    amounts[k] = -prior.mean;  // priors are of changes from where the parameters are
    deviations[k] = prior.deviation;
  }
  // In units of the deviations of the priors, in which the matrix is well scaled.
  information = deviations.asDiagonal() * information * deviations.asDiagonal();
  information += Eigen::MatrixXd::Identity(count, count);
  return LogOrthantFactor(amounts.cwiseQuotient(deviations),
                          information.ldlt().solve(Eigen::MatrixXd::Identity(count, count)));
}

// `misfit` with the residuals whitened as those of `correspondences`, which belong to other values
// of the parameters. For recordings with markers.
LinearisedMisfit ComparedAs(LinearisedMisfit misfit, const LinearisedMisfit& correspondences) {
  for (size_t k = 0; k < misfit.parts.size(); ++k) {
    misfit.parts[k].layout.deformation = correspondences.parts[k].layout.deformation;
    misfit.parts[k].observed = correspondences.parts[k].observed;
  }
  return misfit;
}

// The adopted nuisances of a hypothesis at their best amounts. `columns`: theirs alone; both are
// whitened.
LinearFit FitAdopted(const FittedHypothesis& hypothesis, const Eigen::VectorXd& residual,
                     const Eigen::MatrixXd& columns, const NoiseLevel& noise) {
  const auto own = hypothesis.priors.begin() + hypothesis.parameters;
  return LinearGaussianModel(residual, columns, {own, hypothesis.priors.end()})
      .FitAll(noise.variance);
}

// A change of the parameters in the units of MovedBy, and the log evidence that it would gain.
struct BestStep {
  Eigen::VectorXd change;
  double gain = 0;
};

// The best change within the bounds of the parameters, to first order.
BestStep BestNear(const FittedHypothesis& hypothesis,
                  const std::vector<CalibratedParameter>& parameters, const Eigen::VectorXd& values,
                  const NoiseLevel& noise, bool fitted_only) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::MatrixXd columns =
      WhitenedRows(misfit.jacobian, misfit,
                   {.correlation_time = noise.correlation_time, .fitted_only = fitted_only});
  const Eigen::VectorXd residual =
      WhitenedRows(misfit.residual, misfit,
                   {.correlation_time = noise.correlation_time, .fitted_only = fitted_only});
  QuadraticCost model{0.5 * residual.squaredNorm() / noise.variance,
                      columns.transpose() * residual / noise.variance,
                      columns.transpose() * columns / noise.variance};
  constexpr double kUnbounded = std::numeric_limits<double>::infinity();
  Eigen::VectorXd low = Eigen::VectorXd::Constant(columns.cols(), -kUnbounded), high = -low;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const LinearPrior& prior = hypothesis.priors[static_cast<size_t>(k)];
    if (std::isfinite(prior.deviation)) {
      const double precision = std::pow(prior.deviation, -2);
      model.cost += 0.5 * precision * prior.mean * prior.mean;
      model.gradient[k] -= precision * prior.mean;
      model.information(k, k) += precision;
    }
    if (k >= hypothesis.parameters) continue;
    const CalibratedParameter& parameter = parameters[static_cast<size_t>(k)];
    const auto by = [&](double bound) {
      return parameter.log_scale ? values[k] * std::log(bound / values[k]) : bound - values[k];
    };
    if (!parameter.log_scale || parameter.min > 0) low[k] = std::min(0.0, by(parameter.min));
    high[k] = std::max(0.0, by(parameter.max));
  }
  // In units in which the information has a unit diagonal.
  const Eigen::VectorXd unit = model.information.diagonal()
                                   .cwiseMax(std::numeric_limits<double>::min())
                                   .cwiseSqrt()
                                   .cwiseInverse();
  model.gradient = unit.cwiseProduct(model.gradient);
  model.information = unit.asDiagonal() * model.information * unit.asDiagonal();
  low = low.cwiseQuotient(unit);
  high = high.cwiseQuotient(unit);
  const Eigen::VectorXd step = StepWithin(model, low, high);
  // The evidence has the nuisances at their best amounts already.
  low.head(hypothesis.parameters).setZero();
  high.head(hypothesis.parameters).setZero();
  const Eigen::VectorXd of_nuisances = StepWithin(model, low, high);
  return {unit.cwiseProduct(step), model.cost * (model.GainOf(step) - model.GainOf(of_nuisances))};
}

// Puts the columns of the adopted nuisances after those of the parameters.
void SetNuisances(const AdoptedNuisances& adopted, const LinearisedMisfit& correspondences,
                  FittedHypothesis* hypothesis) {
  const Eigen::MatrixXd& nuisances = adopted.columns;
  Eigen::MatrixXd& columns = hypothesis->misfit.jacobian;
  columns.conservativeResize(Eigen::NoChange, hypothesis->parameters + nuisances.cols());
  columns.rightCols(nuisances.cols()) = nuisances;
  hypothesis->priors.resize(static_cast<size_t>(hypothesis->parameters));
  hypothesis->priors.insert(hypothesis->priors.end(), adopted.priors.begin(), adopted.priors.end());
  hypothesis->residual = hypothesis->misfit.residual;
  if (nuisances.cols() == 0) return;
  const LinearFit fit =
      LinearGaussianModel(WhitenedRows(hypothesis->residual, correspondences),
                          WhitenedRows(nuisances, correspondences), adopted.priors)
          .FitAll(1);
  hypothesis->residual += nuisances * fit.change;
}

}  // namespace

FittedHypothesis HypothesisAt(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const AdoptedNuisances& adopted,
                              const LinearisedMisfit& correspondences, const FittedHypothesis* near,
                              const LinearisedMisfit* known) {
  FittedHypothesis hypothesis;
  if (known != nullptr)
    hypothesis.misfit = ComparedAs(*known, correspondences);
  else
    hypothesis.misfit =
        problem.Linearise(values, {.with_jacobian = near == nullptr,
                                   .correspondences = &correspondences,
                                   .near = near != nullptr ? &near->misfit : &correspondences});
  if (!hypothesis.misfit.usable) return hypothesis;
  hypothesis.priors = PriorsAbout(problem.parameters(), values);
  hypothesis.parameters = static_cast<Eigen::Index>(hypothesis.priors.size());
  hypothesis.positive = PositiveAmounts(problem.parameters());
  if (near != nullptr) hypothesis.misfit.jacobian = near->misfit.jacobian;
  SetNuisances(adopted, correspondences, &hypothesis);
  return hypothesis;
}

HypothesisEvidence EvidenceOf(const FittedHypothesis& hypothesis, const NoiseLevel& noise,
                              bool fitted_only) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::MatrixXd columns =
      WhitenedRows(misfit.jacobian, misfit,
                   {.correlation_time = noise.correlation_time, .fitted_only = fitted_only});
  const Eigen::VectorXd residual =
      WhitenedRows(misfit.residual, misfit,
                   {.correlation_time = noise.correlation_time, .fitted_only = fitted_only});
  // The amounts of adopted nuisances are at their best; the parameters stay where they are.
  const LinearFit adopted = FitAdopted(
      hypothesis, residual, columns.rightCols(columns.cols() - hypothesis.parameters), noise);
  double prior_cost = 0;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const LinearPrior& prior = hypothesis.priors[static_cast<size_t>(k)];
    const double change = k < hypothesis.parameters ? 0 : adopted.change[k - hypothesis.parameters];
    if (std::isfinite(prior.deviation))
      prior_cost += std::pow((change - prior.mean) / prior.deviation, 2);
  }
  // With a residual of zero, the log evidence is the determinant term alone.
  const LinearGaussianModel of_nothing(Eigen::VectorXd::Zero(residual.size()), columns,
                                       WithoutMeans(hypothesis.priors));
  HypothesisEvidence evidence;
  evidence.misfit = adopted.misfit;
  evidence.log_evidence = of_nothing.FitAll(noise.variance).log_evidence -
                          0.5 * (evidence.misfit / noise.variance + prior_cost) +
                          LogTruncation(hypothesis, of_nothing, noise.variance);
  return evidence;
}

Eigen::VectorXd WhitenedResidual(const FittedHypothesis& hypothesis, const NoiseLevel& noise) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::Index adopted = misfit.jacobian.cols() - hypothesis.parameters;
  const Eigen::VectorXd residual =
      WhitenedRows(misfit.residual, misfit, {.correlation_time = noise.correlation_time});
  const Eigen::MatrixXd columns = WhitenedRows(misfit.jacobian.rightCols(adopted), misfit,
                                               {.correlation_time = noise.correlation_time});
  return residual + columns * FitAdopted(hypothesis, residual, columns, noise).change;
}

double RmsOverSigma(const FittedHypothesis& hypothesis) {
  return RmsOverSigma(hypothesis.residual, hypothesis.misfit);
}

double FirstOrderGain(const CalibrationProblem& problem, const Settled& at,
                      const NoiseLevel& noise) {
  return BestNear(at.hypothesis, problem.parameters(), at.values, noise, /*fitted_only=*/false)
      .gain;
}

Settled Settle(const CalibrationProblem& problem, Settled start, const AdoptedNuisances& adopted,
               const LinearisedMisfit& correspondences, const NoiseLevel& noise, bool fitted_only) {
  Settled settled = std::move(start);
  double evidence = EvidenceOf(settled.hypothesis, noise, fitted_only).log_evidence;
  double share = 1;  // of the step
  for (int step = 0; step < kSettlingSteps; ++step) {
    const BestStep best =
        BestNear(settled.hypothesis, problem.parameters(), settled.values, noise, fitted_only);
    if (share * best.gain < kSettledGain) break;
    const Eigen::VectorXd moved =
        MovedBy(problem.parameters(), settled.values, share * best.change);
    FittedHypothesis next =
        HypothesisAt(problem, moved, adopted, correspondences, &settled.hypothesis);
    const double gain =
        next.misfit.usable ? EvidenceOf(next, noise, fitted_only).log_evidence - evidence : -1.0;
    if (!(gain > 0)) {
      share *= kStepReduction;
      continue;
    }
    evidence += gain;
    settled = {moved, std::move(next)};
  }
  return settled;
}

}  // namespace lacuna
