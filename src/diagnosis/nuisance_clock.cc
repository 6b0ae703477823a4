// A clock that is late or early by the same time in all frames of a recording.
#include "diagnosis/nuisance_catalogue.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "clock";
  card.title = "the clock of a recording";
  card.directions = "all frames of a recording later by the same time";
  card.prior = "one frame";
  card.residual_when_present =
      "The residual is proportional to the velocity, with the same factor in all frames.";
  card.advice = "give clock_deviation";
  card.trial.limits_detection = true;
  return card;
}

std::optional<NuisanceCandidate> Make(const RecordingContext& at) {
  // A study with a clock deviation fits the clock.
  if (at.problem.models()[at.part.recording].recording().clock_deviation != 0) return std::nullopt;
  NuisanceCandidate candidate;
  candidate.what = "the clock of " + at.Name();
  candidate.columns = Eigen::MatrixXd::Zero(at.misfit.residual.size(), 1);
  // The load cells of a recording share its clock.
  for (const LinearisedMisfit::Part& part : at.misfit.parts)
    if (part.recording == at.part.recording)
      candidate.columns.middleRows(part.first_row, part.layout.Rows()) = part.speed;
  candidate.priors = {{0, at.spacing, false}};
  return candidate;
}

}  // namespace

NuisanceEntry ClockNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
