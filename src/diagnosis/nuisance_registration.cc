// A coordinate system of the measurement that was set up anew before one of several recordings.
#include <algorithm>

#include "diagnosis/nuisance_catalogue.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "registration";
  card.title = "the coordinate system of a recording";
  card.directions = "all frames of one of several recordings shifted and rotated alike";
  card.prior = "1 mm and 0.02 rad";
  card.residual_when_present =
      "In one recording the whole object is displaced like a rigid body, in all frames alike; in "
      "the others it is not.";
  card.advice = "give registration to that recording";
  card.least_frames = 1;
  card.trial.limits_detection = true;
  return card;
}

std::optional<NuisanceCandidate> Make(const RecordingContext& at) {
  // What all recordings have in common is known from the object's reference shape and its grips.
  const bool is_only_one =
      std::none_of(at.misfit.parts.begin(), at.misfit.parts.end(), [&](const auto& other) {
        return other.IsOfPoints() && other.recording != at.part.recording;
      });
  // A study with such a deviation fits the registration.
  const bool is_fitted = at.problem.models()[at.part.recording].recording().shift_deviation != 0;
  if (is_only_one || is_fitted) return std::nullopt;
  NuisanceCandidate candidate;
  candidate.what = "the coordinate system of " + at.Name();
  candidate.columns = at.RigidColumns([](Eigen::Index) { return 1.0; });
  candidate.priors = RigidMotionPriors();
  return candidate;
}

}  // namespace

NuisanceEntry RegistrationNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
