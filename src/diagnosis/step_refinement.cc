#include "diagnosis/step_refinement.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "analysis/linear_evidence.h"
#include "calibration/calibration_fits.h"
#include "calibration/linear_misfit.h"
#include "calibration/step_errors.h"
#include "core/progress.h"
#include "core/quantity.h"
#include "diagnosis/decision_rules.h"
#include "diagnosis/hypothesis_score.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

// A halving of the time step divides the evidence of the unknown part of its error by at most about
// this number: an error of second order becomes a quarter, and evidence grows with its square.
constexpr double kEvidencePerHalving = 16;

// The evidence that the unknown parts of the step's error and of the other errors of the model
// could contribute to an effect.
struct UnknownEvidence {
  double of_step = 0, of_others = 0;
};
UnknownEvidence UnknownEvidenceOf(const EffectRanking& ranking) {
  UnknownEvidence evidence;
  for (const ScoredNuisance& nuisance : ranking.nuisances)
    (nuisance.candidate.card.shrinks_with_time_step ? evidence.of_step : evidence.of_others) +=
        nuisance.uncertain_evidence;
  return evidence;
}

// The same for the step of `problem`; nothing where the motion, or that with shorter steps, cannot
// be predicted.
std::optional<double> UnknownEvidenceOfStep(const CalibrationProblem& problem,
                                            const Eigen::VectorXd& values,
                                            const NoiseLevel& noise) {
  const LinearisedMisfit misfit = problem.Linearise(values, {.with_jacobian = true});
  if (!misfit.usable) return std::nullopt;
  const std::optional<StepErrors> errors = FindStepErrors(problem, values, misfit);
  if (!errors) return std::nullopt;
  const auto whitened = [&](const Eigen::MatrixXd& rows) {
    return WhitenedRows(rows, misfit, {.correlation_time = noise.correlation_time});
  };
  const LinearGaussianModel unknown(whitened(errors->Unknown()), whitened(misfit.jacobian),
                                    PriorsAbout(problem.parameters(), values));
  const LinearFit left = unknown.Fit(IndexRange(0, misfit.jacobian.cols()), noise.variance);
  return 0.5 * left.misfit / noise.variance;
}

// Says what is known about the choice of the step.
void Say(const std::string& what, Progress* progress) {
  progress->Begin("time step", 0);
  progress->End(what);
}

int HalvingsFor(double excess) {
  return std::max(1, static_cast<int>(std::log(excess) / std::log(kEvidencePerHalving)));
}

}  // namespace

std::optional<ShorterStep> ShortenStep(const CalibrationProblem& problem,
                                       const Eigen::VectorXd& fitted, const EffectRanking& ranking,
                                       Progress* progress) {
  std::optional<ShorterStep> found;
  if (ranking.effects.empty() ||
      ranking.effects.front().score.evidence <= kThresholds.refit.least_evidence)
    return found;
  UnknownEvidence unknown = UnknownEvidenceOf(ranking);
  const double tolerated =
      std::max({kThresholds.refit.uncertain_step_evidence, unknown.of_others,
                kToleratedModelError * ranking.effects.front().score.evidence});
  const int most = kThresholds.refit.most_halvings;
  for (int halvings = 0; halvings < most && unknown.of_step > tolerated;) {
    halvings = std::min(most, halvings + HalvingsFor(unknown.of_step / tolerated));
    PredictionStudy study = problem.WithEstimatedNoise();
    study.time_step = std::ldexp(study.time_step, -halvings);
    const double before = (found ? *found->study : problem.study()).time_step;
    Say(fmt::format("{}, because the error of steps of {} could look like an effect",
                    DurationText(study.time_step), DurationText(before)),
        progress);
    ShorterStep shorter{std::make_unique<const PredictionStudy>(std::move(study)), nullptr, {}};
    shorter.problem =
        std::make_unique<const CalibrationProblem>(*shorter.study, problem.body()->mesh);
    Calibration fit = RefineFit(*shorter.problem, found ? found->values : fitted, progress);
    if (fit.parameters.size() != fitted.size()) {
      Say(fmt::format("{}, because shorter steps could not be fitted", DurationText(before)),
          progress);
      break;
    }
    shorter.values = std::move(fit.parameters);
    found = std::move(shorter);
    if (halvings == most) break;
    const std::optional<double> of_step =
        UnknownEvidenceOfStep(*found->problem, found->values, ranking.noise);
    if (!of_step) {
      Say(fmt::format("{}; its error is not known, because the motion could not be predicted with "
                      "shorter steps",
                      DurationText(found->study->time_step)),
          progress);
      break;
    }
    unknown.of_step = *of_step;
  }
  return found;
}

}  // namespace lacuna
