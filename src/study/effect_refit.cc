#include "study/effect_refit.h"

#include <fmt/format.h>
#include <glog/logging.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "study/calibration_fits.h"
#include "study/model_change.h"
#include "study/recording_misfit.h"

namespace lacuna {
namespace {

// A rival need not be at its very best to be told from one that fits.
constexpr int kIterations = 25;
constexpr double kTolerance = 1;  // of the cost, whose unit is one standard deviation
// Of the steps that then take the held-out frames in: the most, by how much those that lead nowhere
// are shortened, and the log evidence to be won below which none is made.
constexpr int kSettlingSteps = 5;
constexpr double kShorter = 0.3;
constexpr double kSettled = 0.5;
// A refit begins this part of the way to what first order expects: the first that predicts better
// than the model without the effect. Moduli that fall below a part of themselves are not believed.
constexpr double kPartsOfTheWay[] = {1, 0.1, 1e-2, 1e-3, 1e-4};
constexpr double kSoundPart = 0.2;
// Or at these parts of the size that first order expects, one after another, with everything but
// the effect fitted to each; the effect is held by a prior of this part of what is typical.
constexpr double kSizesHeld[] = {0.1, 0.3, 1};
constexpr double kHeld = 1e-3;
// σ: what a refit leaves that has found its way. One that leaves 1.8 may end 1.1 from elsewhere.
constexpr double kArrived = 1.2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The rows of fitted frames, in the order of CalibrationProblem::Predict.
Eigen::MatrixXd FittedRows(const Eigen::MatrixXd& rows, const LinearisedMisfit& misfit) {
  Eigen::MatrixXd kept(rows.rows(), rows.cols());
  Eigen::Index count = 0;
  for (const LinearisedMisfit::Part& part : misfit.parts) {
    for (size_t f = 0; f < part.fitted.size(); ++f) {
      if (!part.fitted[f]) continue;
      const Eigen::Index first = part.first_row + static_cast<Eigen::Index>(f) * part.layout.series;
      kept.middleRows(count, part.layout.series) = rows.middleRows(first, part.layout.series);
      count += part.layout.series;
    }
  }
  kept.conservativeResize(count, Eigen::NoChange);
  return kept;
}

// Where a parameter that makes the effect's size has no effect; of other parameters, nothing.
std::optional<double> NullOf(const ScoredVariant& scored, const ModelParameter& parameter) {
  const auto [effect, index] = parameter.places.front();
  const std::vector<int>& amplitude = scored.candidate.amplitude;
  if (std::count(amplitude.begin(), amplitude.end(), index) == 0) return std::nullopt;
  return effect->Card().parameters[index].null_value;
}

std::vector<LinearPrior> WithoutMeans(std::vector<LinearPrior> priors) {
  for (LinearPrior& prior : priors) {
    prior.mean = 0;
    prior.positive = false;
  }
  return priors;
}

}  // namespace

ModelErrors ErrorsOf(const CalibrationProblem& problem, const Eigen::VectorXd& values) {
  double fitted = 0, held_out = 0, fitted_noise = 0, held_out_noise = 0;
  double unfitted_noise = 0;
  int fitted_points = 0, held_out_points = 0, unfitted_points = 0;
  const std::vector<RecordingMisfit> misfits = MisfitsOf(problem, values);
  for (size_t r = 0; r < misfits.size(); ++r) {
    const MisfitMeasure &in_fit = misfits[r].in_fit, &out = misfits[r].held_out;
    if (!problem.models()[r].item().fitted) {
      unfitted_noise += out.in_noise * out.in_noise * out.points;
      unfitted_points += out.points;
    }
    fitted += in_fit.rms * in_fit.rms * in_fit.points;
    fitted_noise += in_fit.in_noise * in_fit.in_noise * in_fit.points;
    fitted_points += in_fit.points;
    held_out += out.rms * out.rms * out.points;
    held_out_noise += out.in_noise * out.in_noise * out.points;
    held_out_points += out.points;
  }
  ModelErrors errors;
  if (unfitted_points > 0) errors.unfitted_in_noise = std::sqrt(unfitted_noise / unfitted_points);
  errors.has_held_out = held_out_points > 0;
  if (fitted_points > 0) {
    errors.in_fit_rms = std::sqrt(fitted / fitted_points);
    errors.in_noise = std::sqrt(fitted_noise / fitted_points);
  }
  errors.held_out_rms = errors.in_fit_rms;
  if (errors.has_held_out) {
    errors.held_out_rms = std::sqrt(held_out / held_out_points);
    errors.in_noise = std::sqrt(held_out_noise / held_out_points);
  }
  return errors;
}

namespace {

// Compared with what `same` was compared with; with the derivatives that it has there, or, given
// `near`, that it had there.
FittedHypothesis HypothesisAt(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                              const AdoptedNuisances& adopted, const LinearisedMisfit& same,
                              const FittedHypothesis* near = nullptr) {
  FittedHypothesis hypothesis;
  hypothesis.misfit = problem.Linearise(values, near == nullptr, {}, &same);
  if (!hypothesis.misfit.usable) return hypothesis;
  hypothesis.priors = PriorsAbout(problem.parameters(), values);
  hypothesis.parameters = static_cast<Eigen::Index>(hypothesis.priors.size());
  Eigen::MatrixXd& by = hypothesis.misfit.by;
  if (near != nullptr) {
    by = near->misfit.by;
  } else {
    by.conservativeResize(Eigen::NoChange, hypothesis.parameters + adopted.by.cols());
    by.rightCols(adopted.by.cols()) = adopted.by;
  }
  hypothesis.priors.insert(hypothesis.priors.end(), adopted.priors.begin(), adopted.priors.end());
  hypothesis.left = hypothesis.misfit.residual;
  if (adopted.by.cols() > 0) {
    const LinearFit fit = LinearModel(WhitenedRows(hypothesis.left, same, 0, false),
                                      WhitenedRows(adopted.by, same, 0, false), adopted.priors)
                              .FitAll(1);
    hypothesis.left += adopted.by * fit.change;
  }
  return hypothesis;
}

}  // namespace

HypothesisEvidence EvidenceOf(const FittedHypothesis& hypothesis, const NoiseLevel& noise,
                              bool fitted_only) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  const Eigen::MatrixXd columns =
      WhitenedRows(misfit.by, misfit, noise.correlation_time, fitted_only);
  const Eigen::VectorXd residual =
      WhitenedRows(misfit.residual, misfit, noise.correlation_time, fitted_only);
  const auto own = hypothesis.priors.begin() + hypothesis.parameters;
  // What was adopted is linear, hence at its best; the parameters are where they are.
  const LinearFit adopted =
      LinearModel(residual, columns.rightCols(columns.cols() - hypothesis.parameters),
                  {own, hypothesis.priors.end()})
          .FitAll(noise.variance);
  double prior_cost = 0;
  for (Eigen::Index k = 0; k < columns.cols(); ++k) {
    const LinearPrior& prior = hypothesis.priors[static_cast<size_t>(k)];
    const double change = k < hypothesis.parameters ? 0 : adopted.change[k - hypothesis.parameters];
    if (std::isfinite(prior.deviation))
      prior_cost += std::pow((change - prior.mean) / prior.deviation, 2);
  }
  // The determinant is that of the linear model, whatever its residual.
  const LinearFit nothing =
      LinearModel(Eigen::VectorXd::Zero(residual.size()), columns, WithoutMeans(hypothesis.priors))
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

FurtherEvidence FurtherEvidenceOf(const FittedHypothesis& hypothesis,
                                  const std::vector<TriedVariant>& tried, const std::string& type,
                                  const NoiseLevel& noise) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  Eigen::Index width = misfit.by.cols();
  for (const TriedVariant& variant : tried) width += variant.by.cols();
  Eigen::MatrixXd columns(misfit.by.rows(), width);
  columns.leftCols(misfit.by.cols()) = misfit.by;
  std::vector<LinearPrior> priors = hypothesis.priors;
  for (const TriedVariant& variant : tried) {
    columns.middleCols(static_cast<Eigen::Index>(priors.size()), variant.by.cols()) = variant.by;
    priors.insert(priors.end(), variant.priors.begin(), variant.priors.end());
  }
  const LinearModel model(WhitenedRows(misfit.residual, misfit, noise.correlation_time, false),
                          WhitenedRows(columns, misfit, noise.correlation_time, false), priors);
  std::vector<int> chosen(hypothesis.priors.size());
  std::iota(chosen.begin(), chosen.end(), 0);
  const double before = model.Fit(chosen, noise.variance).log_evidence;
  FurtherEvidence best;
  int column = static_cast<int>(chosen.size());
  for (const TriedVariant& variant : tried) {
    std::vector<int> with = chosen;
    for (size_t k = 0; k < variant.priors.size(); ++k) with.push_back(column++);
    if (variant.type == type) continue;
    const double evidence = model.Fit(with, noise.variance).log_evidence - before - variant.price;
    if (variant.is_nuisance) {
      best.of_nuisance = std::max(best.of_nuisance, evidence);
    } else if (evidence > best.evidence) {
      best.type = variant.type;
      best.evidence = evidence;
    }
  }
  return best;
}

FurtherEvidence FurtherEvidenceAlong(const CalibrationProblem& problem,
                                     const Eigen::VectorXd& values, const ScoredVariant& effect,
                                     const EffectRefit& refit,
                                     const std::vector<std::string>& without, Progress* progress) {
  const PredictionStudy study = WithEffect(problem.AsChosen(), effect);
  const CalibrationProblem with(study, problem.body()->mesh);
  const EffectRanking ranking = RankEffects(with, refit.calibration.parameters, progress, without);
  problem.SetModel(values);
  FurtherEvidence best;
  for (const ScoredEffect& other : ranking.effects) {
    if (other.candidate.type == effect.candidate.type || other.score.evidence <= best.evidence)
      continue;
    best.type = other.candidate.type;
    best.evidence = other.score.evidence;
  }
  for (const ScoredNuisance& nuisance : ranking.nuisances)
    if (!nuisance.adopted) best.of_nuisance = std::max(best.of_nuisance, nuisance.evidence);
  return best;
}

namespace {

// To first order, at the parameters that are best for all frames.
LinearFit BestNear(const FittedHypothesis& hypothesis) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  return LinearModel(WhitenedRows(misfit.residual, misfit, 0, false),
                     WhitenedRows(misfit.by, misfit, 0, false), hypothesis.priors)
      .FitAll(1);
}

// The hypothesis at the parameters that are best for all frames, sought from `values`, where it is
// `hypothesis`: the held-out ones move them little, and the derivatives less.
FittedHypothesis SettledHypothesis(const CalibrationProblem& problem, Eigen::VectorXd values,
                                   const AdoptedNuisances& adopted, const LinearisedMisfit& same,
                                   FittedHypothesis hypothesis) {
  const NoiseLevel white;
  double evidence = EvidenceOf(hypothesis, white).log_evidence;
  double part = 1;  // of the step that first order proposes
  for (int step = 0; step < kSettlingSteps; ++step) {
    const LinearFit best = BestNear(hypothesis);
    if (best.log_evidence - evidence < kSettled) break;
    const Eigen::VectorXd moved = MovedBy(problem.parameters(), values, part * best.change);
    FittedHypothesis next = HypothesisAt(problem, moved, adopted, same, &hypothesis);
    const double gain = next.misfit.usable ? EvidenceOf(next, white).log_evidence - evidence : -1.0;
    if (!(gain > 0)) {
      part *= kShorter;
      continue;
    }
    values = moved;
    evidence += gain;
    hypothesis = std::move(next);
  }
  return hypothesis;
}

// The problem with one more effect, as a fit: its parameters, then the amounts of what was adopted.
class ExtendedProblem {
 public:
  // As Refit().
  ExtendedProblem(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                  const ScoredVariant* effect, const AdoptedNuisances& adopted,
                  const LinearisedMisfit& misfit)
      : values_(values),
        effect_(effect),
        study_(effect != nullptr ? WithEffect(problem.AsChosen(), *effect) : problem.AsChosen()),
        with_(study_, problem.body()->mesh),
        shared_(static_cast<Eigen::Index>(problem.study().fitted.size())),
        added_(static_cast<Eigen::Index>(study_.fitted.size()) - shared_),
        own_(static_cast<Eigen::Index>(with_.parameters().size())),
        present_(FittedRows(WhitenedRows(misfit.residual, misfit, 0, true), misfit)),
        nuisance_(FittedRows(WhitenedRows(adopted.by, misfit, 0, true), misfit)),
        parameters_(with_.parameters()) {
    for (const LinearPrior& prior : adopted.priors) {
      CalibratedParameter amount;
      amount.name = "nuisance";
      amount.start = amount.prior_mean = prior.mean;
      amount.prior_deviation = amount.typical = prior.deviation;
      amount.is_linear = true;
      parameters_.push_back(amount);
    }
  }

  const CalibrationProblem& with() const { return with_; }
  // The one that the problem has more; with the values of the last prediction.
  const Effect& OwnEffect() const {
    return effect_->candidate.replaces_material ? *study_.effects.front() : *study_.effects.back();
  }
  Eigen::Index OwnCount() const { return own_; }  // of the parameters, without the amounts
  // Of a calibration's estimates, those of what makes the effect's size.
  std::vector<ParameterEstimate> SizesIn(const Calibration& calibration) const {
    const auto first = calibration.estimates.begin() + shared_;
    return {first, first + static_cast<Eigen::Index>(effect_->candidate.amplitude.size())};
  }

  // Where a fit is to begin.
  Eigen::VectorXd Start() const {
    const Eigen::VectorXd present = PartWay(1, values_);
    if (effect_ == nullptr) return present;
    Eigen::VectorXd expected = effect_->fitted;
    for (Eigen::Index k = 0; k < shared_; ++k)
      if (parameters_[k].log_scale && !(expected[k] > kSoundPart * values_[k])) expected = values_;
    const double without = (present_ + nuisance_ * present.tail(present.size() - own_)).norm();
    Eigen::VectorXd start = present;
    double least = Missed(start);
    for (const double part : kPartsOfTheWay) {
      const Eigen::VectorXd at = PartWay(part, expected);
      if (const double there = Missed(at); there < least) {
        least = there;
        start = at;
      }
      if (least < without || effect_->candidate.IsPilot()) break;
    }
    return start;
  }

  // With the effect held at a size, everything else where it is best: what a size asks of the other
  // parameters is no straight line. Empty: nothing could be fitted.
  Eigen::VectorXd StartAtItsSize(const std::string& stage, Progress* progress) const {
    Eigen::VectorXd start;
    double least = kInfinity;
    for (const double part : kSizesHeld) {
      const Eigen::VectorXd of_part = PartWay(part, values_);
      Eigen::VectorXd at = start.size() > 0 ? start : of_part;
      at.segment(shared_, added_) = of_part.segment(shared_, added_);
      const Calibration fitted = CalibrateFrom(at, stage, progress, /*holds_effect=*/true);
      if (fitted.estimates.empty() || fitted.rms >= least) continue;
      least = fitted.rms;
      start = fitted.parameters;
    }
    return start;
  }

  Calibration CalibrateFrom(const Eigen::VectorXd& start, const std::string& stage,
                            Progress* progress, bool holds_effect = false) const {
    std::vector<CalibratedParameter> parameters = parameters_;
    for (size_t k = 0; k < parameters.size(); ++k) {
      CalibratedParameter& parameter = parameters[k];
      parameter.start = start[static_cast<Eigen::Index>(k)];
      const Eigen::Index own = static_cast<Eigen::Index>(k) - shared_;
      if (!holds_effect || own < 0 || own >= added_) continue;
      parameter.prior_mean = parameter.start;
      parameter.prior_deviation = kHeld * parameter.typical;
    }
    int evaluations = 0;
    const auto predict = [&](const Eigen::VectorXd& at, bool with_jacobian) {
      const Prediction prediction = Predict(at, with_jacobian);
      progress->Report(++evaluations,
                       prediction.usable ? RootMeanSquare(prediction.residual) : std::nan(""));
      return prediction;
    };
    progress->Begin(stage, 0);
    const Calibration calibration = Calibrate(
        parameters, predict,
        {.max_iterations = kIterations, .cost_tolerance = kTolerance, .near_rms = kInfinity});
    progress->End(calibration.usable ? "" : calibration.message);
    return calibration;
  }

 private:
  // Adopted nuisances change the misfit as they did at the model without the effect.
  Prediction Predict(const Eigen::VectorXd& at, bool with_jacobian) const {
    Prediction prediction = with_.Predict(at.head(own_), with_jacobian);
    if (!prediction.usable) return prediction;
    prediction.residual += nuisance_ * at.tail(at.size() - own_);
    if (with_jacobian) {
      prediction.jacobian.conservativeResize(Eigen::NoChange, at.size());
      prediction.jacobian.rightCols(at.size() - own_) = nuisance_;
    }
    return prediction;
  }

  double Missed(const Eigen::VectorXd& at) const {
    const Prediction prediction = Predict(at, /*with_jacobian=*/false);
    return prediction.usable ? prediction.residual.norm() : kInfinity;
  }

  // From the present parameters towards others, and the effect from nothing towards the size that
  // it begins with.
  Eigen::VectorXd PartWay(double part, const Eigen::VectorXd& towards) const {
    const Eigen::VectorXd of_problem = values_ + part * (towards - values_);
    Eigen::VectorXd at(static_cast<Eigen::Index>(parameters_.size()));
    for (Eigen::Index k = 0; k < at.size(); ++k) at[k] = parameters_[k].start;
    at.head(shared_) = of_problem.head(shared_);
    at.segment(shared_ + added_, own_ - shared_ - added_) =
        of_problem.tail(own_ - shared_ - added_);
    for (Eigen::Index k = shared_; k < shared_ + added_; ++k)
      if (const std::optional<double> null = NullOf(*effect_, study_.fitted[k]))
        at[k] = *null + part * (at[k] - *null);
    for (Eigen::Index k = 0; k < at.size(); ++k)
      at[k] = std::clamp(at[k], parameters_[k].min, parameters_[k].max);
    return at;
  }

  const Eigen::VectorXd& values_;
  const ScoredVariant* effect_;
  PredictionStudy study_;
  CalibrationProblem with_;
  // How many of the parameters are the model's, then the effect's, and, with those of recordings,
  // all of with_'s.
  Eigen::Index shared_, added_, own_;
  Eigen::VectorXd present_;   // whitened misfit of the model without the effect, fitted frames
  Eigen::MatrixXd nuisance_;  // and how what was adopted changes it, per unit
  std::vector<CalibratedParameter> parameters_;
};

}  // namespace

EffectRefit Refit(const CalibrationProblem& problem, const Eigen::VectorXd& values,
                  const ScoredVariant* effect, const AdoptedNuisances& adopted,
                  const LinearisedMisfit& misfit, bool is_far_off, Progress* progress,
                  RefitFrom from) {
  const ExtendedProblem extended(problem, values, effect, adopted, misfit);
  const CalibrationProblem& with = extended.with();
  const Eigen::Index own = extended.OwnCount();
  const std::string stage = effect != nullptr ? "refit " + effect->candidate.type : "refit";
  EffectRefit refit;
  Eigen::VectorXd start;
  if (from == RefitFrom::kItsSize) start = extended.StartAtItsSize(stage + " at a size", progress);
  if (start.size() == 0) start = extended.Start();
  refit.calibration = extended.CalibrateFrom(start, stage, progress);
  const bool arrived = !refit.calibration.estimates.empty() && refit.calibration.rms <= kArrived;
  if (effect != nullptr && is_far_off && !arrived) {
    // The model without the effect was fitted to what it cannot do: begin where that did.
    const Calibration afresh = FitFrom(with, with.Start(), progress);
    if (afresh.parameters.size() == own) {
      start.head(own) = afresh.parameters;
      const Calibration other = extended.CalibrateFrom(start, stage + " from there", progress);
      if (!other.estimates.empty() &&
          (refit.calibration.estimates.empty() || other.rms < refit.calibration.rms))
        refit.calibration = other;
    }
  }
  if (refit.calibration.estimates.empty()) {
    refit.message = refit.calibration.message;
  } else {
    const Eigen::VectorXd amounts =
        refit.calibration.parameters.tail(refit.calibration.parameters.size() - own);
    refit.calibration.parameters.conservativeResize(own);
    refit.calibration.estimates.resize(static_cast<size_t>(own));
    refit.hypothesis = HypothesisAt(with, refit.calibration.parameters, adopted, misfit);
    refit.errors = ErrorsOf(with, refit.calibration.parameters);
    if (effect != nullptr) {
      refit.effect = extended.OwnEffect().Parameters();
      refit.sizes = extended.SizesIn(refit.calibration);
    }
    refit.message = refit.hypothesis.misfit.message;
    if (refit.hypothesis.misfit.usable) {
      refit.errors.without_nuisances = HeldOutInNoise(
          WhitenedRows(refit.hypothesis.misfit.residual + adopted.by * amounts, misfit, 0, false),
          misfit);
      refit.at_fit = refit.hypothesis;
      refit.hypothesis = SettledHypothesis(with, refit.calibration.parameters, adopted, misfit,
                                           std::move(refit.hypothesis));
    }
  }
  problem.SetModel(values);  // the refit has changed effects that both models share
  return refit;
}

}  // namespace lacuna
