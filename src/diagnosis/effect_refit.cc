#include "diagnosis/effect_refit.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "calibration/recording_misfit.h"
#include "diagnosis/model_change.h"

namespace lacuna {
namespace {

// Of the steps that then take the held-out frames in: the most, by how much those that lead nowhere
// are shortened, and the log evidence to be won below which none is made.
constexpr int kSettlingSteps = 5;
constexpr double kShorter = 0.3;
constexpr double kSettled = 0.5;
// σ: what a refit leaves that has found its way. One that leaves 1.8 may end 1.1 from elsewhere.
constexpr double kArrived = 1.2;
// Parts: of what first order promises, that a refit keeps; of what is more than noise, that one
// explains that first order promised too much; of the noise, within which it is known.
constexpr double kKept = 0.5, kFoundItsWay = 0.85, kMoreThanEstimated = 0.2;
// Held-out misses of models that differ by noise are nearer than this.
constexpr double kMissesMore = 1.1;

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
    const LinearFit fit =
        LinearGaussianModel(WhitenedRows(hypothesis.left, same, 0, false),
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
  // The determinant is that of the linear model, whatever its residual.
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
  const LinearGaussianModel model(
      WhitenedRows(misfit.residual, misfit, noise.correlation_time, false),
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

FurtherEvidence FurtherEvidenceAlong(const PresentModel& present, const ScoredVariant& effect,
                                     const EffectRefit& refit,
                                     const std::vector<std::string>& without) {
  const PredictionStudy study = WithEffect(present.problem.StudyAt(present.values), effect);
  const CalibrationProblem with(study, present.problem.body()->mesh);
  const EffectRanking ranking =
      RankEffects(with, refit.calibration.parameters, present.progress, without);
  FurtherEvidence best;
  const auto other = std::find_if(
      ranking.effects.begin(), ranking.effects.end(),
      [&](const ScoredEffect& e) { return e.candidate.type != effect.candidate.type; });
  if (other != ranking.effects.end() && other->score.evidence > 0) {
    best.type = other->candidate.type;
    best.evidence = other->score.evidence;
  }
  for (const ScoredNuisance& nuisance : ranking.nuisances)
    if (!nuisance.adopted) best.of_nuisance = std::max(best.of_nuisance, nuisance.evidence);
  return best;
}

namespace {

// To first order, at the parameters that are best for all frames.
LinearFit BestNear(const FittedHypothesis& hypothesis) {
  const LinearisedMisfit& misfit = hypothesis.misfit;
  return LinearGaussianModel(WhitenedRows(misfit.residual, misfit, 0, false),
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

}  // namespace

bool FallsShort(const HypothesisEvidence& without, const HypothesisEvidence& refit, double noise,
                double promised) {
  const double more_than_noise = without.misfit - noise;
  const bool found_its_way = more_than_noise > kMoreThanEstimated * noise &&
                             without.misfit - refit.misfit >= kFoundItsWay * more_than_noise;
  return refit.log_evidence - without.log_evidence < kKept * promised && !found_its_way;
}

bool PredictsWorse(const ModelErrors& with, const ModelErrors& without) {
  return with.has_held_out && with.without_nuisances > kMissesMore * without.without_nuisances;
}

EffectRefit Refit(const PresentModel& present, const ScoredVariant* effect,
                  const AdoptedNuisances& adopted, bool is_far_off, RefitFrom from) {
  const LinearisedMisfit& misfit = present.misfit;
  const ExtendedProblem extended(present, effect, adopted);
  const CalibrationProblem& with = extended.problem();
  const Eigen::Index own = extended.OwnCount();
  const std::string stage = effect != nullptr ? "refit " + effect->candidate.type : "refit";
  EffectRefit refit;
  Eigen::VectorXd start;
  if (from == RefitFrom::kItsSize) start = extended.StartAtItsSize(stage + " at a size");
  if (start.size() == 0) start = extended.Start();
  refit.calibration = extended.CalibrateFrom(start, stage);
  const bool arrived = !refit.calibration.estimates.empty() && refit.calibration.rms <= kArrived;
  // The start at its size has been fitted afresh already.
  if (effect != nullptr && is_far_off && !arrived && from == RefitFrom::kFirstOrder) {
    // The model without the effect was fitted to what it cannot do: begin where that did.
    const Calibration afresh = extended.CalibrateAfresh();
    if (afresh.parameters.size() == own) {
      start.head(own) = afresh.parameters;
      const Calibration other = extended.CalibrateFrom(start, stage + " from there");
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
      refit.effect = extended.OwnParameters(refit.calibration.parameters);
      refit.sizes = extended.SizesIn(refit.calibration);
      refit.others = extended.OthersIn(refit.calibration);
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
  return refit;
}

}  // namespace lacuna
