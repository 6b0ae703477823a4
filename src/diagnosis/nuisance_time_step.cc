// The error of the time step.
//
// With the residuals r, r½ and r¼ for the step h, h/2 and h/4, Richardson's extrapolation (Phil.
// Trans. A 210, 1911) to h → 0 is r¼ + (r¼ − r½)/(p − 1), where p is the factor by which the change
// falls with each halving. The first column is the change to that limit, the second the departure
// of the two halvings from the factor p.
#include <algorithm>
#include <cmath>

#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "time_step";
  card.title = "the length of the time step";
  card.directions =
      "the change of the prediction with infinitely short steps, extrapolated from a half and a "
      "quarter of the step, and the departure of the two from the order of the scheme";
  card.prior = "the extrapolation, and how far it is uncertain";
  card.residual_when_present =
      "The time scheme damps and slows fast vibrations, so its residual looks like that of "
      "damping.";
  card.advice = "choose a smaller motion.time_step";
  card.source = NuisanceSource::kDiscretisation;
  card.is_always_in_model = true;
  card.is_shared_in_scene = true;
  card.shrinks_with_time_step = true;
  card.trial.limits_detection = true;
  return card;
}

// The factor p. A scheme of first order may converge with second order, and effects with memory may
// reduce the order, so p is the observed one (Roache, Verification and Validation in Computational
// Science and Engineering, 1998), between that of the scheme and second order.
double ChangePerHalving(TimeScheme scheme, const Eigen::VectorXd& whole,
                        const Eigen::VectorXd& half, const Eigen::VectorXd& quarter) {
  constexpr double kSecondOrder = 4;
  const double least = std::exp2(OrderOf(scheme));
  const double along = (half - whole).dot(quarter - half);
  if (!(along > 0)) return least;
  return std::clamp((half - whole).squaredNorm() / along, least, kSecondOrder);
}

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  const auto with_steps = [&](double ratio) {
    PredictionStudy study = at.problem.WithEstimatedNoise();
    study.time_step /= ratio;
    return CalibrationProblem(study, at.problem.body()->mesh)
        .Linearise(at.values, false, {}, nullptr, &at.misfit)
        .residual;
  };
  const Eigen::VectorXd& whole = at.misfit.residual;
  const Eigen::VectorXd half = with_steps(2), quarter = with_steps(4);
  if (half.size() != whole.size() || quarter.size() != half.size()) return std::nullopt;
  const double power = ChangePerHalving(at.problem.study().scheme, whole, half, quarter);
  NuisanceCandidate candidate;
  candidate.columns.resize(half.size(), 2);
  candidate.columns << quarter + (quarter - half) / (power - 1) - whole,
      (quarter - half) - (half - whole) / power;
  const NuisanceThresholds& thresholds = kThresholds.nuisances;
  candidate.priors = {{1, thresholds.step_limit, false}, {0, thresholds.step_unknown, false}};
  candidate.unknown = thresholds.step_unknown * candidate.columns.col(1);
  return candidate;
}

}  // namespace

NuisanceEntry TimeStepNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
