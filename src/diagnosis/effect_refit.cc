#include "diagnosis/effect_refit.h"

#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "calibration/held_out_misfit.h"
#include "core/parallel.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
ModelErrors ErrorsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                     const LinearisedMisfit* known) {
  double fitted = 0, held_out = 0, fitted_noise = 0, held_out_noise = 0;
  double unfitted_noise = 0, unfitted_squares = 0;
  int fitted_points = 0, held_out_points = 0, unfitted_points = 0;
  const std::vector<RecordingMisfit> misfits = MisfitsOf(problem, values, known);
  for (size_t r = 0; r < misfits.size(); ++r) {
    const MisfitMeasure &in_fit = misfits[r].in_fit, &out = misfits[r].held_out;
    if (!problem.models()[r].recording().fitted) {
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

RefitEvidence EvidenceOf(const EffectRefit& refit, const NoiseLevel& noise) {
  const HypothesisEvidence all = EvidenceOf(refit.hypothesis, noise);
  const double fitted = EvidenceOf(refit.at_fit, noise, /*fitted_only=*/true).log_evidence;
  return {all.log_evidence, all.log_evidence - fitted, all.misfit};
}

namespace {

// Sets what a refit says of the fitted frames and of all frames, from a hypothesis near both.
void SettleRefit(const CalibrationProblem& problem, const RefitSetting& setting, Settled start,
                 EffectRefit* refit) {
  const BaselineModel& baseline = setting.model;
  Settled fitted = Settle(problem, std::move(start), setting.adopted, baseline.misfit,
                          baseline.noise, /*fitted_only=*/true);
  refit->at_fit = fitted.hypothesis;
  refit->values_at_fit = fitted.values;
  refit->hypothesis = Settle(problem, std::move(fitted), setting.adopted, baseline.misfit,
                             baseline.noise, /*fitted_only=*/false)
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

int FittedRecordings(const CalibrationProblem& problem) {
  const auto& models = problem.models();
  return static_cast<int>(std::count_if(
      models.begin(), models.end(), [](const auto& model) { return model.recording().fitted; }));
}

bool IsBetter(const Calibration& a, const Calibration& b) {
  return a.HasSolution() && (!b.HasSolution() || a.rms < b.rms);
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
    return fit.calibration.HasSolution() && fit.calibration.rms <= kThresholds.refit.rms_at_noise;
  };
  const auto fit_from_start = [&] {
    fit = extended.CalibrateFrom(start, stage, hopeless_cost, progress);
  };
  // The recordings are predicted side by side. Where threads are left, the second start is looked
  // for during the first fit. It is not used where the first fit is good, so that the result is the
  // same.
  if (ThreadCount() > FittedRecordings(extended.problem())) {
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
  if (fit.calibration.HasSolution()) hopeless_cost = std::min(hopeless_cost, fit.calibration.cost);
  ExtendedFit other =
      extended.CalibrateFrom(afresh.parameters, stage + ", second start", hopeless_cost, progress);
  const int predictions =
      fit.calibration.predictions + afresh.predictions + other.calibration.predictions;
  ExtendedFit& better = IsBetter(other.calibration, fit.calibration) ? other : fit;
  better.calibration.predictions = predictions;
  return std::move(better);
}

std::string StageOf(const ScoredVariant* effect) {
  return effect != nullptr ? "refit " + effect->candidate.type : "refit";
}

ExtendedFit FitExtended(const ExtendedProblem& extended, const ScoredVariant* effect,
                        const RefitOptions& options, Progress* progress) {
  const std::string stage = StageOf(effect);
  FitStart start;
  if (options.from == RefitFrom::kFixedSize)
    start = extended.StartAtFixedSize(stage + " at a size");
  if (start.values.size() == 0) {
    Eigen::VectorXd refitted;
    if (effect != nullptr && options.without != nullptr && options.without->message.empty())
      refitted = options.without->calibration.parameters;
    const int of_held_fits = start.predictions;
    start = extended.Start(refitted);
    start.predictions += of_held_fits;
  }
  // A fit with the effect held at a size has given another start already.
  ExtendedFit fit =
      effect != nullptr && options.is_far_off && options.from == RefitFrom::kFirstOrder
          ? FitFromTwoStarts(extended, stage, start.values, options.hopeless_cost, progress)
          : extended.CalibrateFrom(start.values, stage, options.hopeless_cost, progress);
  fit.calibration.predictions += start.predictions;
  return fit;
}

// Sets what depends on the nuisances beside a refit, whose hypothesis is that at `values`, and
// `settles` the refit.
void FinishBeside(const ExtendedProblem& extended, const RefitSetting& setting,
                  const Eigen::VectorXd& values, bool settles, EffectRefit* refit) {
  const LinearisedMisfit& of_baseline = setting.model.misfit;
  const LinearisedMisfit& misfit = refit->hypothesis.misfit;
  refit->message = misfit.message;
  if (!misfit.usable) return;
  refit->nuisance_amounts = extended.AmountsAt(misfit);
  const Eigen::VectorXd residual =
      misfit.residual + setting.adopted.columns * refit->nuisance_amounts;
  const Eigen::VectorXd white = WhitenedRows(residual, of_baseline);
  refit->errors.without_nuisances = HeldOutInNoise(white, of_baseline);
  if (settles) {
    SettleRefit(extended.problem(), setting, {values, std::move(refit->hypothesis)}, refit);
  } else {
    refit->at_fit = refit->hypothesis;
    refit->values_at_fit = values;
  }
}

// What a fit says of its effect, of the fitted frames and of all frames.
EffectRefit FinishedRefit(ExtendedFit fit, const ExtendedProblem& extended,
                          const RefitSetting& setting, const ScoredVariant* effect,
                          double hopeless_cost) {
  const LinearisedMisfit& misfit = setting.model.misfit;
  const CalibrationProblem& with = extended.problem();
  EffectRefit refit;
  refit.calibration = std::move(fit.calibration);
  const Calibration& calibration = refit.calibration;
  if (!calibration.HasSolution()) {
    refit.message = calibration.message;
    return refit;
  }
  if (!calibration.usable) refit.unconverged = calibration.message;
  const bool is_hopeless = calibration.cost > hopeless_cost;
  if (calibration.usable && is_hopeless)
    refit.unconverged = "the search has ended too far from the measurements to be followed further";
  // With markers, one prediction serves both.
  LinearisedMisfit own_misfit = std::move(fit.misfit);
  if (!own_misfit.usable && !with.HasScans())
    own_misfit = with.Linearise(calibration.parameters, {.with_jacobian = true, .near = &misfit});
  const LinearisedMisfit* known = own_misfit.usable ? &own_misfit : nullptr;
  refit.hypothesis =
      HypothesisAt(with, calibration.parameters, setting.adopted, misfit, nullptr, known);
  refit.errors = ErrorsOf(with, calibration.parameters, known);
  if (effect != nullptr) {
    refit.effect_values = extended.OwnParameters(calibration.parameters);
    refit.baseline_values = calibration.parameters.head(
        static_cast<Eigen::Index>(setting.model.problem.study().fitted.size()));
    refit.sizes = extended.SizesIn(calibration);
    refit.at_limit = extended.SizesAtLimit(calibration);
    refit.others = extended.OthersIn(calibration);
  }
  FinishBeside(extended, setting, calibration.parameters, !is_hopeless, &refit);
  return refit;
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

bool IsContradicted(const EffectRefit& with, const EffectRefit& without, const NoiseLevel& noise,
                    int tests) {
  // At most one in so many recordings in which the effect is missing refutes it. Larger values keep
  // more wrong effects that fail later in the motion.
  constexpr double kOneIn = 100;
  return without.errors.has_held_out &&
         !(PredictiveGain(with, without, noise) >= -std::log(kOneIn * tests));
}

bool Predicts(const EffectRefit& with, const EffectRefit& without, const NoiseLevel& noise,
              int tests) {
  return !with.unconverged.empty() || with.IsAtLimit() ||
         !IsContradicted(with, without, noise, tests);
}

bool PredictsWorse(const ModelErrors& with, const ModelErrors& without) {
  return with.has_held_out &&
         with.without_nuisances > kThresholds.refit.held_out_growth * without.without_nuisances;
}

EffectRefit Refit(const RefitSetting& setting, const ScoredVariant* effect,
                  const RefitOptions& options) {
  const ExtendedProblem extended(setting.model, effect, setting.adopted);
  ExtendedFit fit = FitExtended(extended, effect, options, setting.model.progress);
  return FinishedRefit(std::move(fit), extended, setting, effect, options.hopeless_cost);
}

EffectRefit RefitFromValues(const RefitSetting& setting, const ScoredVariant* effect,
                            const Eigen::VectorXd& values, double hopeless_cost) {
  const ExtendedProblem extended(setting.model, effect, setting.adopted);
  const std::vector<CalibratedParameter>& parameters = extended.problem().parameters();
  CHECK_EQ(values.size(), static_cast<Eigen::Index>(parameters.size()));
  Eigen::VectorXd start = values;
  for (size_t k = 0; k < parameters.size(); ++k) {
    double& value = start[static_cast<Eigen::Index>(k)];
    value = std::clamp(value, parameters[k].min, parameters[k].max);
  }
  ExtendedFit fit =
      extended.CalibrateFrom(start, StageOf(effect), hopeless_cost, setting.model.progress);
  return FinishedRefit(std::move(fit), extended, setting, effect, hopeless_cost);
}

EffectRefit ContinueWithinBudget(const RefitSetting& setting, const ScoredVariant* effect,
                                 EffectRefit refit, double hopeless_cost, int predictions) {
  predictions += refit.calibration.predictions;
  while (predictions < kThresholds.refit.most_of_effect && refit.message.empty() &&
         !refit.unconverged.empty() && refit.calibration.cost <= hopeless_cost) {
    EffectRefit further =
        RefitFromValues(setting, effect, refit.calibration.parameters, hopeless_cost);
    predictions += further.calibration.predictions;
    if (!further.message.empty()) break;
    const double gained = refit.calibration.cost - further.calibration.cost;
    refit = std::move(further);
    if (!(gained > 0)) break;
  }
  return refit;
}

EffectRefit RefitWithout(const RefitSetting& setting) {
  return ContinueWithinBudget(setting, nullptr, Refit(setting, nullptr));
}

namespace {

EffectRefit MovedBeside(const ExtendedProblem& extended, const RefitSetting& setting,
                        EffectRefit refit, bool settles) {
  const Eigen::VectorXd values = refit.values_at_fit;
  refit.hypothesis = HypothesisAt(extended.problem(), values, setting.adopted, setting.model.misfit,
                                  nullptr, &refit.at_fit.misfit);
  FinishBeside(extended, setting, values, settles, &refit);
  return refit;
}

}  // namespace

MovedRefit MovedBeside(const RefitSetting& setting, const ScoredVariant& effect, EffectRefit refit,
                       const NoiseLevel& noise) {
  const ExtendedProblem extended(setting.model, &effect, setting.adopted);
  MovedRefit moved{MovedBeside(extended, setting, std::move(refit), /*settles=*/false)};
  if (!moved.refit.message.empty()) return moved;
  const Eigen::VectorXd& values = moved.refit.values_at_fit;
  const FittedHypothesis& hypothesis = moved.refit.hypothesis;
  moved.gain_in_reach = FirstOrderGain(extended.problem(), {values, hypothesis}, noise);
  moved.first_step = extended.FirstStepFrom(values, hypothesis.misfit);
  return moved;
}

EffectRefit SettledBeside(const RefitSetting& setting, const ScoredVariant& effect,
                          EffectRefit refit) {
  const ExtendedProblem extended(setting.model, &effect, setting.adopted);
  return MovedBeside(extended, setting, std::move(refit), /*settles=*/true);
}

}  // namespace lacuna
