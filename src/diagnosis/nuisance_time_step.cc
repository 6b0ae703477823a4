// The error of the time step: the change to infinitely short steps, and the part of it that is
// unknown (calibration/step_errors.h).
#include "calibration/step_errors.h"
#include "diagnosis/nuisance_catalogue.h"

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

std::optional<NuisanceCandidate> Make(const NuisanceContext& at) {
  const std::optional<StepErrors> errors = FindStepErrors(at.problem, at.values, at.misfit);
  if (!errors) return Untried(at, "the motion could not be predicted with a shorter step");
  NuisanceCandidate candidate;
  candidate.columns.resize(errors->to_limit.size(), 2);
  candidate.columns << errors->to_limit, errors->departure;
  candidate.priors = {{1, StepErrors::kLimitDeviation, false},
                      {0, StepErrors::kDepartureDeviation, false}};
  candidate.unknown = errors->Unknown();
  return candidate;
}

}  // namespace

NuisanceEntry TimeStepNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
