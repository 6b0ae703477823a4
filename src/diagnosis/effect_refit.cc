#include "diagnosis/effect_refit.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibration/held_out_misfit.h"
#include "core/parallel.h"
#include "diagnosis/thresholds.h"
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

}  // namespace

ModelErrors ErrorsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                     const LinearisedMisfit* known) {
  double fitted = 0, held_out = 0, fitted_noise = 0, held_out_noise = 0;
  double unfitted_noise = 0, unfitted_squares = 0;
  int fitted_points = 0, held_out_points = 0, unfitted_points = 0;
  const std::vector<RecordingMisfit> misfits = MisfitsOf(problem, values, known);
  for (size_t r = 0; r < misfits.size(); ++r) {
    const MisfitMeasure &in_fit = misfits[r].in_fit, &out = misfits[r].held_out;
    if (!problem.models()[r].item().fitted) {
      const double squares = out.rms_over_sigma * out.rms_over_sigma * out.points;
      unfitted_noise += squares;
      unfitted_points += out.points;
      unfitted_squares += problem.models()[r].observer().Components() * squares;
      for (const FittedReaction& reaction : misfits[r].reactions)
        unfitted_squares +=
            reaction.held_out.values * std::pow(reaction.held_out.rms_over_sigma, 2);
    }
    fitted += in_fit.rms * in_fit.rms * in_fit.points;
    fitted_noise += in_fit.rms_over_sigma * in_fit.rms_over_sigma * in_fit.points;
    fitted_points += in_fit.points;
    held_out += out.rms * out.rms * out.points;
    held_out_noise += out.rms_over_sigma * out.rms_over_sigma * out.points;
    held_out_points += out.points;
  }
  ModelErrors errors;
  if (unfitted_points > 0)
    errors.unfitted_rms_over_sigma = std::sqrt(unfitted_noise / unfitted_points);
  errors.has_held_out = held_out_points > 0;
  if (fitted_points > 0) {
    errors.in_fit_rms = std::sqrt(fitted / fitted_points);
    errors.rms_over_sigma = std::sqrt(fitted_noise / fitted_points);
  }
  errors.held_out_rms = errors.in_fit_rms;
  errors.unfitted_squares = unfitted_squares;
  if (errors.has_held_out) {
    errors.held_out_rms = std::sqrt(held_out / held_out_points);
    errors.rms_over_sigma = std::sqrt(held_out_noise / held_out_points);
  }
  return errors;
}

namespace {

// `misfit` with the residuals whitened as those of `correspondences`, which belong to other values
// of the parameters. For recordings with markers.
LinearisedMisfit ComparedAs(LinearisedMisfit misfit, const LinearisedMisfit& correspondences) {
  for (size_t k = 0; k < misfit.parts.size(); ++k) {
    misfit.parts[k].layout.deformation = correspondences.parts[k].layout.deformation;
    misfit.parts[k].observed = correspondences.parts[k].observed;
  }
  return misfit;
}

// Replaces the columns of the adopted nuisances of a hypothesis, after those of the parameters.
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
      LinearGaussianModel(WhitenedRows(hypothesis->residual, correspondences, 0, false),
                          WhitenedRows(nuisances, correspondences, 0, false), adopted.priors)
          .FitAll(1);
  hypothesis->residual += nuisances * fit.change;
}

// The model at `values`, with the residuals between the same points as in `correspondences`. Given
// `near`, its Jacobian is used instead of a new one; given `known`, the misfit with Jacobian at
// `values`, nothing is predicted.
FittedHypothesis HypothesisAt(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const AdoptedNuisances& adopted,
                              const LinearisedMisfit& correspondences,
                              const FittedHypothesis* near = nullptr,
                              const LinearisedMisfit* known = nullptr) {
  FittedHypothesis hypothesis;
  if (known != nullptr)
    hypothesis.misfit = ComparedAs(*known, correspondences);
  else
    hypothesis.misfit = problem.Linearise(values, near == nullptr, {}, &correspondences,
                                          near != nullptr ? &near->misfit : &correspondences);
  if (!hypothesis.misfit.usable) return hypothesis;
  hypothesis.priors = PriorsAbout(problem.parameters(), values);
  hypothesis.parameters = static_cast<Eigen::Index>(hypothesis.priors.size());
  if (near != nullptr) hypothesis.misfit.jacobian = near->misfit.jacobian;
  SetNuisances(adopted, correspondences, &hypothesis);
  return hypothesis;
}

}  // namespace

HypothesisEvidence EvidenceOf(const FittedHypothesis& hypothesis, const NoiseLevel& noise,
                              bool fitted_only) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::MatrixXd columns =
      WhitenedRows(misfit.jacobian, misfit, noise.correlation_time, fitted_only);
  const Eigen::VectorXd residual =
      WhitenedRows(misfit.residual, misfit, noise.correlation_time, fitted_only);
  const auto own = hypothesis.priors.begin() + hypothesis.parameters;
  // The amounts of adopted nuisances are at their best; the parameters stay where they are.
  const LinearFit adopted =
      LinearGaussianModel(residual, columns.rightCols(columns.cols() - hypothesis.parameters),
                          {own, hypothesis.priors.end()})
          .FitAll(noise.variance);
  double prior_cost = 0;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const LinearPrior& prior = hypothesis.priors[static_cast<size_t>(k)];
    const double change = k < hypothesis.parameters ? 0 : adopted.change[k - hypothesis.parameters];
    if (std::isfinite(prior.deviation))
      prior_cost += std::pow((change - prior.mean) / prior.deviation, 2);
  }
  // With a residual of zero, the log evidence is the determinant term alone.
  const LinearFit nothing = LinearGaussianModel(Eigen::VectorXd::Zero(residual.size()), columns,
                                                WithoutMeans(hypothesis.priors))
                                .FitAll(noise.variance);
  HypothesisEvidence evidence;
  evidence.misfit = adopted.misfit;
  evidence.log_evidence =
      nothing.log_evidence - 0.5 * (evidence.misfit / noise.variance + prior_cost);
  return evidence;
}

RefitEvidence EvidenceOf(const EffectRefit& refit, const NoiseLevel& noise) {
  const HypothesisEvidence all = EvidenceOf(refit.hypothesis, noise);
  const double fitted = EvidenceOf(refit.at_fit, noise, /*fitted_only=*/true).log_evidence;
  return {all.log_evidence, all.log_evidence - fitted, all.misfit};
}

HypothesisSpace SpaceOf(const FittedHypothesis& hypothesis, const EffectRanking& ranking,
                        const std::string& type, const NoiseLevel& noise) {
  return SpaceBeside(hypothesis.misfit, hypothesis.misfit.jacobian, hypothesis.priors, ranking,
                     type, noise);
}

namespace {

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
      WhitenedRows(misfit.jacobian, misfit, noise.correlation_time, fitted_only);
  const Eigen::VectorXd residual =
      WhitenedRows(misfit.residual, misfit, noise.correlation_time, fitted_only);
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

// A hypothesis, and the values of the problem's parameters there.
struct Settled {
  Eigen::VectorXd values;
  FittedHypothesis hypothesis;
};

// The hypothesis at the best parameters for all frames or for those that were fitted, by
// Gauss–Newton steps from `start`. The steps are small, so the Jacobian is kept.
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

// Sets what a refit says of the fitted frames and of all frames, from a hypothesis near both.
void SettleRefit(const CalibrationProblem& problem, const AdoptedNuisances& adopted,
                 const BaselineModel& baseline, Settled start, EffectRefit* refit) {
  Settled fitted = Settle(problem, std::move(start), adopted, baseline.misfit, baseline.noise,
                          /*fitted_only=*/true);
  refit->at_fit = fitted.hypothesis;
  refit->values_at_fit = fitted.values;
  refit->hypothesis = Settle(problem, std::move(fitted), adopted, baseline.misfit, baseline.noise,
                             /*fitted_only=*/false)
                          .hypothesis;
}

// By how much the variance of a mean over frames exceeds that of independent noise.
double PersistenceOf(const NoiseLevel& noise, const LinearisedMisfit& misfit) {
  double persistence = 1;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    const std::vector<double>& times = part.layout.times;
    if (times.size() < 2 || !(noise.correlation_time > 0)) continue;
    const double spacing = (times.back() - times.front()) / static_cast<double>(times.size() - 1);
    const double next = std::exp(-spacing / noise.correlation_time);
    persistence = std::max(persistence, (1 + next) / (1 - next));
  }
  return persistence;
}

bool IsBetter(const Calibration& a, const Calibration& b) {
  return !a.estimates.empty() && (b.estimates.empty() || a.rms < b.rms);
}

// The better of the fits from two starts: the baseline's parameters, and those of a fit of the
// model with the effect from the study's own start. The baseline was fitted to what it cannot
// explain, so its parameters may be a bad start. A first fit that comes down to the noise is good
// enough; otherwise, the second ends early where it would not come below the first.
ExtendedFit FitFromTwoStarts(const ExtendedProblem& extended, const std::string& stage,
                             const Eigen::VectorXd& start, double hopeless_cost,
                             Progress* progress) {
  ExtendedFit fit;
  Calibration afresh;
  const auto is_good = [&] {
    return !fit.calibration.estimates.empty() &&
           fit.calibration.rms <= kThresholds.refit.converged_rms;
  };
  const auto fit_from_start = [&] {
    fit = extended.CalibrateFrom(start, stage, hopeless_cost, progress);
  };
  // With several threads, the second start is looked for during the first fit. It is not used where
  // the first fit is good, so that the result is the same.
  if (ThreadCount() > 1) {
    Progress silent({.style = ProgressStyle::kSilent});
    ParallelFor(2, 1, [&](int64_t k) {
      if (k == 0)
        fit_from_start();
      else
        afresh = extended.CalibrateAfresh(&silent);
    });
  } else {
    fit_from_start();
    if (!is_good()) afresh = extended.CalibrateAfresh(progress);
  }
  if (is_good() || afresh.parameters.size() != start.size()) return fit;
  if (!fit.calibration.estimates.empty())
    hopeless_cost = std::min(hopeless_cost, fit.calibration.cost);
  ExtendedFit other =
      extended.CalibrateFrom(afresh.parameters, stage + ", second start", hopeless_cost, progress);
  const int predictions =
      fit.calibration.predictions + afresh.predictions + other.calibration.predictions;
  ExtendedFit& better = IsBetter(other.calibration, fit.calibration) ? other : fit;
  better.calibration.predictions = predictions;
  return std::move(better);
}

ExtendedFit FitExtended(const ExtendedProblem& extended, const std::string& stage, bool is_far_off,
                        RefitFrom from, const Eigen::VectorXd& refitted, double hopeless_cost,
                        Progress* progress) {
  Eigen::VectorXd start;
  if (from == RefitFrom::kFixedSize) start = extended.StartAtFixedSize(stage + " at a size");
  if (start.size() == 0) start = extended.Start(refitted);
  // A fit with the effect held at a size has given another start already.
  return is_far_off && from == RefitFrom::kFirstOrder
             ? FitFromTwoStarts(extended, stage, start, hopeless_cost, progress)
             : extended.CalibrateFrom(start, stage, hopeless_cost, progress);
}

}  // namespace

bool FallsShort(const HypothesisEvidence& without, const HypothesisEvidence& refit, double noise,
                double predicted) {
  const RefitThresholds& thresholds = kThresholds.refit;
  const double excess = without.misfit - noise;
  const bool explains_excess =
      excess > thresholds.noise_uncertainty * noise &&
      without.misfit - refit.misfit >= thresholds.explained_excess * excess;
  return refit.log_evidence - without.log_evidence < thresholds.kept_share * predicted &&
         !explains_excess;
}

double PredictiveGain(const EffectRefit& with, const EffectRefit& without,
                      const NoiseLevel& noise) {
  const double squares = with.errors.unfitted_squares - without.errors.unfitted_squares;
  return EvidenceOf(with, noise).held_out - EvidenceOf(without, noise).held_out -
         0.5 * squares / (noise.variance * PersistenceOf(noise, with.hypothesis.misfit));
}

bool Predicts(const EffectRefit& with, const EffectRefit& without, const NoiseLevel& noise) {
  // Of recordings in which the effect is missing, one in so many at most refutes it. More: wrong
  // effects that fail later in the motion stay possible.
  constexpr double kOneIn = 100;
  return !without.errors.has_held_out || PredictiveGain(with, without, noise) >= -std::log(kOneIn);
}

bool PredictsWorse(const ModelErrors& with, const ModelErrors& without) {
  return with.has_held_out &&
         with.without_nuisances > kThresholds.refit.held_out_growth * without.without_nuisances;
}

EffectRefit Refit(const BaselineModel& baseline, const ScoredVariant* effect,
                  const AdoptedNuisances& adopted, bool is_far_off, RefitFrom from,
                  const EffectRefit* without, double hopeless_cost) {
  const LinearisedMisfit& misfit = baseline.misfit;
  const ExtendedProblem extended(baseline, effect, adopted);
  const CalibrationProblem& with = extended.problem();
  Eigen::VectorXd refitted;
  if (effect != nullptr && without != nullptr && without->message.empty())
    refitted = without->calibration.parameters;
  ExtendedFit fit = FitExtended(
      extended, effect != nullptr ? "refit " + effect->candidate.type : "refit",
      effect != nullptr && is_far_off, from, refitted, hopeless_cost, baseline.progress);
  EffectRefit refit;
  refit.calibration = std::move(fit.calibration);
  if (refit.calibration.estimates.empty()) {
    refit.message = refit.calibration.message;
  } else {
    // With markers, one prediction serves both.
    LinearisedMisfit own_misfit = std::move(fit.misfit);
    if (!own_misfit.usable && !with.HasScans())
      own_misfit = with.Linearise(refit.calibration.parameters, true, {}, nullptr, &misfit);
    const LinearisedMisfit* known = own_misfit.usable ? &own_misfit : nullptr;
    refit.hypothesis =
        HypothesisAt(with, refit.calibration.parameters, adopted, misfit, nullptr, known);
    refit.errors = ErrorsOf(with, refit.calibration.parameters, known);
    if (effect != nullptr) {
      refit.effect = extended.OwnParameters(refit.calibration.parameters);
      refit.model = refit.calibration.parameters.head(
          static_cast<Eigen::Index>(baseline.problem.study().fitted.size()));
      refit.sizes = extended.SizesIn(refit.calibration);
      refit.others = extended.OthersIn(refit.calibration);
    }
    refit.message = refit.hypothesis.misfit.message;
    if (refit.hypothesis.misfit.usable) {
      refit.amounts = extended.AmountsAt(refit.hypothesis.misfit);
      const Eigen::VectorXd residual =
          refit.hypothesis.misfit.residual + adopted.columns * refit.amounts;
      const Eigen::VectorXd white = WhitenedRows(residual, misfit, 0, false);
      refit.errors.without_nuisances = HeldOutInNoise(white, misfit);
      SettleRefit(with, adopted, baseline,
                  {refit.calibration.parameters, std::move(refit.hypothesis)}, &refit);
    }
  }
  return refit;
}

EffectRefit BesideNuisances(const BaselineModel& baseline, const ScoredVariant& effect,
                            const AdoptedNuisances& adopted, EffectRefit refit) {
  const ExtendedProblem extended(baseline, &effect, adopted);
  Settled start{refit.values_at_fit, refit.at_fit};
  SetNuisances(adopted, baseline.misfit, &start.hypothesis);
  SettleRefit(extended.problem(), adopted, baseline, std::move(start), &refit);
  return refit;
}

}  // namespace lacuna
