#include "diagnosis/extended_problem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <ranges>

#include "calibration/calibration_fits.h"
#include "calibration/linear_misfit.h"
#include "core/hash.h"
#include "diagnosis/model_change.h"
#include "diagnosis/thresholds.h"
#include "fit/bounded_steps.h"
#include "fit/prior_cost.h"

namespace lacuna {
namespace {

// A refit has to be good enough for a comparison, not converged to the last digit.
constexpr int kIterations = 30;
constexpr double kTolerance = 1;  // of the cost, in units of one standard deviation
// Start() tries these shares of the step that first order predicts, until one gives a smaller
// residual than the model without the effect.
constexpr double kStepShares[] = {1, 0.1, 1e-2, 1e-3, 1e-4};
// The shares of the effect's predicted size that it tries beside the refitted baseline. Each costs
// a prediction, and a fit that starts too far away several.
constexpr double kSharesBesideRefitted[] = {1, 0.1};
// StartAtFixedSize() holds the effect at these shares of its predicted size, one after another, by
// a prior with this share of the typical value.
constexpr double kSizeShares[] = {0.1, 0.3, 1};
constexpr double kHoldDeviation = 1e-3;
constexpr int kHoldIterations = 8;  // the result only is the start of the next fit
// The derivatives of a search also cover the held-out frames where at least this share of all
// frames is fitted: those of the last step are then the ones that the evidence needs. A search
// takes derivatives about four times, so that covering all frames each time costs more below this
// share.
constexpr double kCoveredShare = 0.75;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The null value of a parameter that makes the effect's size; nothing for another parameter.
std::optional<double> NullOf(const ScoredVariant& scored, const ModelParameter& parameter) {
  const int index = parameter.places.front().index;
  const std::vector<int>& amplitude = scored.candidate.amplitude;
  if (std::count(amplitude.begin(), amplitude.end(), index) == 0) return std::nullopt;
  return scored.candidate.effect->Card().parameters[index].null_value;
}

PredictionStudy Extended(const BaselineModel& baseline, const ScoredVariant* effect) {
  const PredictionStudy study = baseline.problem.StudyAt(baseline.values);
  return effect != nullptr ? WithEffect(study, *effect) : study;
}

bool CoversHeldOut(const CalibrationProblem& problem) {
  if (problem.HasScans()) return false;
  size_t fitted = 0, all = 0;
  for (const RecordingModel& model : problem.models()) {
    if (!model.recording().fitted) continue;
    fitted += model.recording().FittedFrames().size();
    all += model.recording().frames.size();
  }
  return static_cast<double>(fitted) >= kCoveredShare * static_cast<double>(all);
}

void Append(const Eigen::MatrixXd& numbers, std::string* bytes) {
  bytes->append(reinterpret_cast<const char*>(numbers.data()),
                static_cast<size_t>(numbers.size()) * sizeof(double));
}

}  // namespace

BaselineModel RankedBaseline(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                             const EffectRanking& ranking, Progress* progress, FitStore* kept) {
  return {problem, values, ranking.misfit, progress, kept, ranking.noise, ranking.ModelError()};
}

ExtendedProblem::ExtendedProblem(const BaselineModel& baseline, const ScoredVariant* effect,
                                 const AdoptedNuisances& adopted)
    : baseline_(baseline),
      effect_(effect),
      study_(Extended(baseline, effect)),
      with_(study_, baseline.problem.body()->mesh),
      shared_(static_cast<Eigen::Index>(baseline.problem.study().fitted.size())),
      added_(static_cast<Eigen::Index>(study_.fitted.size()) - shared_),
      residual_(
          FittedRows(WhitenedRows(baseline.misfit.residual, baseline.misfit, {.fitted_only = true}),
                     baseline.misfit)),
      nuisances_(FittedRows(WhitenedRows(adopted.columns, baseline.misfit, {.fitted_only = true}),
                            baseline.misfit),
                 adopted.priors),
      covers_held_out_(CoversHeldOut(with_)),
      parameters_(with_.parameters()) {}

Eigen::VectorXd ExtendedProblem::AmountsAt(const LinearisedMisfit& misfit) const {
  return nuisances_.BestAmounts(FittedRows(
      WhitenedRows(misfit.residual, baseline_.misfit, {.fitted_only = true}), baseline_.misfit));
}

Eigen::VectorXd ExtendedProblem::OwnParameters(const Eigen::VectorXd& values) const {
  const EffectList effects = WithValues(study_.effects, study_.fitted, values);
  return (effect_->candidate.replaces_material ? effects.front() : effects.back())->Parameters();
}

std::vector<ParameterEstimate> ExtendedProblem::SizesIn(const Calibration& calibration) const {
  std::vector<ParameterEstimate> sizes;
  for (size_t k = 0; k < effect_->candidate.amplitude.size(); ++k)
    sizes.push_back(Reported(calibration, static_cast<size_t>(shared_) + k));
  return sizes;
}

std::vector<bool> ExtendedProblem::SizesAtLimit(const Calibration& calibration) const {
  std::vector<bool> at_limit;
  for (size_t k = 0; k < effect_->candidate.amplitude.size(); ++k) {
    const size_t at = static_cast<size_t>(shared_) + k;
    const ParameterEstimate& estimate = calibration.estimates[at];
    const double null = NullOf(*effect_, study_.fitted[at]).value_or(0);
    // On a logarithmic scale, the effect almost vanishes at the lower end.
    const double below = estimate.value - parameters_[at].min;
    const double above = parameters_[at].max - estimate.value;
    at_limit.push_back(estimate.determination == Determination::kAtBound &&
                       (above < below ? parameters_[at].max > null : parameters_[at].min < null));
  }
  return at_limit;
}

std::vector<NamedEstimate> ExtendedProblem::OthersIn(const Calibration& calibration) const {
  std::vector<NamedEstimate> others;
  const size_t first = static_cast<size_t>(shared_) + effect_->candidate.amplitude.size();
  for (size_t k = first; k < static_cast<size_t>(shared_ + added_); ++k)
    others.push_back({parameters_[k].name, with_.UnitOf(k), Reported(calibration, k)});
  return others;
}

ParameterEstimate ExtendedProblem::Reported(const Calibration& calibration, size_t k) const {
  ParameterEstimate estimate = calibration.estimates[k];
  // The deviation of the estimate grows with the residual that a refit leaves; the error does not.
  const double unknown = std::sqrt(2 * baseline_.model_error * baseline_.noise.variance) /
                         std::max(1.0, calibration.rms);
  WidenIntervalByModelErrors(parameters_[k], estimate.value, unknown * estimate.posterior_deviation,
                             &estimate);
  return estimate;
}

FitStart ExtendedProblem::Start(const Eigen::VectorXd& refitted) const {
  const Eigen::VectorXd& values = baseline_.values;
  FitStart start{PartWay(1, values)};
  if (effect_ == nullptr) return start;
  const double least_share = kThresholds.refit.least_modulus_share;
  // A linear prediction that takes a modulus to almost nothing or below holds for none of the
  // values, because they are predicted together.
  const Eigen::VectorXd& predicted = effect_->expected_values;
  const auto is_far_below = [&](Eigen::Index k) {
    return parameters_[k].log_scale && !(predicted[k] > least_share * values[k]);
  };
  const bool fails = std::ranges::any_of(std::views::iota(Eigen::Index{0}, shared_), is_far_below);
  const Eigen::VectorXd& expected = fails ? values : predicted;
  const double without = nuisances_.OfResidual(residual_).norm();
  double least = kInfinity;
  const auto try_at = [&](const Eigen::VectorXd& at) {
    ++start.predictions;
    if (const double norm = ResidualNorm(at); norm < least) {
      least = norm;
      start.values = at;
    }
  };
  try_at(start.values);
  for (const double share : kStepShares) {
    // First order may predict the baseline's own values, which have been tried.
    if (const Eigen::VectorXd at = PartWay(share, expected); at != start.values) try_at(at);
    if (least < without || effect_->candidate.IsPilot()) break;
  }
  for (const double share : kSharesBesideRefitted) {
    if (refitted.size() == 0) break;
    try_at(WithEffectBy(share, refitted));
    if (effect_->candidate.IsPilot()) break;
  }
  return start;
}

FitStart ExtendedProblem::StartAtFixedSize(const std::string& stage) const {
  const int most = kThresholds.refit.most_predictions;
  FitStart start;
  double least = kInfinity;
  for (const double share : kSizeShares) {
    if (start.predictions >= most) break;
    const Eigen::VectorXd part_way = PartWay(share, baseline_.values);
    Eigen::VectorXd at = start.values.size() > 0 ? start.values : part_way;
    at.segment(shared_, added_) = part_way.segment(shared_, added_);
    // Far from the measurements is not hopeless here: the effect is kept from explaining them.
    const Calibration fitted = Fit(ParametersFrom(at, /*holds_effect=*/true), stage,
                                   {.max_iterations = kHoldIterations,
                                    .cost_tolerance = kTolerance,
                                    .max_predictions = most - start.predictions},
                                   baseline_.progress)
                                   .calibration;
    start.predictions += fitted.predictions;
    if (!fitted.HasSolution() || fitted.rms >= least) continue;
    least = fitted.rms;
    start.values = fitted.parameters;
  }
  return start;
}

FirstStep ExtendedProblem::FirstStepFrom(const Eigen::VectorXd& at,
                                         const LinearisedMisfit& misfit) const {
  const ResidualEvaluation there = FittedEvaluation(misfit);
  const std::vector<CalibratedParameter> parameters = ParametersFrom(at, /*holds_effect=*/false);
  Eigen::MatrixXd columns = nuisances_.OfDerivatives(there.jacobian.leftCols(at.size()));
  DeriveByFreeValues(parameters, at, &columns);
  const QuadraticCost model =
      CostAbout(parameters, at, nuisances_.OfResidual(there.residual), columns);
  const Eigen::VectorXd step = BoundedSteps(parameters).Step(model, at, kInfinity);
  return {model.cost, model.cost * model.GainOf(step)};
}

std::vector<CalibratedParameter> ExtendedProblem::ParametersFrom(const Eigen::VectorXd& start,
                                                                 bool holds_effect) const {
  std::vector<CalibratedParameter> parameters = parameters_;
  for (size_t k = 0; k < parameters.size(); ++k) {
    CalibratedParameter& parameter = parameters[k];
    parameter.start = start[static_cast<Eigen::Index>(k)];
    const Eigen::Index own = static_cast<Eigen::Index>(k) - shared_;
    if (!holds_effect || own < 0 || own >= added_) continue;
    parameter.prior_mean = parameter.start;
    parameter.prior_deviation = kHoldDeviation * parameter.typical;
  }
  return parameters;
}

std::string ExtendedProblem::KeyOf(const std::vector<CalibratedParameter>& parameters,
                                   const std::string& purpose, double hopeless_cost) const {
  std::string all = purpose;
  if (effect_ != nullptr) {
    all += effect_->candidate.type + effect_->candidate.variant;
    Append(effect_->candidate.effect->Parameters(), &all);
  }
  for (const CalibratedParameter& parameter : parameters)
    Append(Eigen::Vector3d(parameter.start, parameter.prior_mean, parameter.prior_deviation), &all);
  Append(Eigen::Vector2d(study_.time_step, hopeless_cost), &all);
  Append(residual_, &all);
  Append(nuisances_.projection(), &all);
  Append(nuisances_.at_means(), &all);
  return HashBytes(all);
}

Calibration ExtendedProblem::Kept(const std::string& purpose,
                                  const std::vector<CalibratedParameter>& parameters,
                                  double hopeless_cost,
                                  const std::function<Calibration()>& fit) const {
  if (baseline_.kept == nullptr) return fit();
  return baseline_.kept->FindOrFit(KeyOf(parameters, purpose, hopeless_cost), fit);
}

ExtendedFit ExtendedProblem::CalibrateFrom(const Eigen::VectorXd& start, const std::string& stage,
                                           double hopeless_cost, Progress* progress) const {
  return Fit(ParametersFrom(start, /*holds_effect=*/false), stage,
             {.max_iterations = kIterations,
              .cost_tolerance = kTolerance,
              .max_predictions = kThresholds.refit.most_predictions,
              .hopeless_cost = hopeless_cost},
             progress);
}

ExtendedFit ExtendedProblem::Fit(const std::vector<CalibratedParameter>& parameters,
                                 const std::string& stage, const CalibrationOptions& options,
                                 Progress* progress) const {
  Memory memory;
  int evaluations = 0;
  const auto predict = [&](const Eigen::VectorXd& at, bool with_jacobian) {
    const ResidualEvaluation prediction = Predict(at, with_jacobian, &memory);
    progress->Report(++evaluations, prediction.usable ? RootMeanSquare(prediction) : std::nan(""));
    return prediction;
  };
  progress->Begin(stage, 0);
  ExtendedFit fit;
  fit.calibration = Kept("fit", parameters, options.hopeless_cost,
                         [&] { return Calibrate(parameters, predict, options); });
  progress->End(fit.calibration.usable ? "" : fit.calibration.message);
  if (memory.latest.usable && memory.of_latest == fit.calibration.parameters)
    fit.misfit = std::move(memory.latest);
  return fit;
}

Calibration ExtendedProblem::CalibrateAfresh(Progress* progress) const {
  return Kept("afresh", with_.parameters(), kInfinity,
              [&] { return FitInStages(with_, with_.Start(), progress); });
}

ResidualEvaluation ExtendedProblem::Predict(const Eigen::VectorXd& at, bool with_jacobian,
                                            Memory* memory) const {
  ResidualEvaluation prediction;
  if (with_jacobian && covers_held_out_) {
    // The last such prediction becomes the fit's misfit.
    memory->latest = with_.Linearise(at, {.with_jacobian = true, .near = &baseline_.misfit});
    memory->of_latest = at;
    prediction = FittedEvaluation(memory->latest);
  } else {
    memory->of_problem.correspondences.clear();  // each prediction finds its own
    prediction = with_.Predict(at, with_jacobian, kInfinity, &memory->of_problem);
  }
  if (!prediction.usable) return prediction;
  prediction.residual = nuisances_.OfResidual(prediction.residual);
  if (with_jacobian) prediction.jacobian = nuisances_.OfDerivatives(prediction.jacobian);
  return prediction;
}

double ExtendedProblem::ResidualNorm(const Eigen::VectorXd& at) const {
  Memory memory;
  const ResidualEvaluation prediction = Predict(at, /*with_jacobian=*/false, &memory);
  return prediction.usable ? prediction.residual.norm() : kInfinity;
}

Eigen::VectorXd ExtendedProblem::PartWay(double share, const Eigen::VectorXd& target) const {
  return WithEffectBy(share, baseline_.values + share * (target - baseline_.values));
}

Eigen::VectorXd ExtendedProblem::WithEffectBy(double share, const Eigen::VectorXd& own) const {
  Eigen::VectorXd at(static_cast<Eigen::Index>(parameters_.size()));
  for (Eigen::Index k = 0; k < at.size(); ++k) at[k] = parameters_[k].start;
  at.head(shared_) = own.head(shared_);
  const Eigen::Index of_recordings = at.size() - shared_ - added_;
  at.tail(of_recordings) = own.tail(of_recordings);
  for (Eigen::Index k = shared_; k < shared_ + added_; ++k)
    if (const std::optional<double> null = NullOf(*effect_, study_.fitted[k]))
      at[k] = *null + share * (at[k] - *null);
  for (Eigen::Index k = 0; k < at.size(); ++k)
    at[k] = std::clamp(at[k], parameters_[k].min, parameters_[k].max);
  return at;
}

}  // namespace lacuna
