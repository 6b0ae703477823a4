// A coordinate system of the measurement that moves slowly, and evenly, during a recording.
#include "diagnosis/nuisance_catalogue.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "registration_drift";
  card.title = "a slow drift of the coordinate system of the measurement";
  card.directions = "the coordinate system shifted and rotated in proportion to the time";
  card.prior = "1 mm and 0.02 rad over the recording";
  card.residual_when_present =
      "The whole object moves away like a rigid body, from the first frame to the last.";
  card.advice = "register the recording to the fixture";
  card.trial.limits_detection = true;
  return card;
}

std::optional<NuisanceCandidate> Make(const RecordingContext& at) {
  const std::vector<double>& times = at.part.layout.times;
  const double duration = times.back() - times.front();
  NuisanceCandidate candidate;
  candidate.what = "a slow drift of the coordinate system of " + at.Name();
  candidate.columns = at.RigidColumns([&](Eigen::Index frame) {
    return (times[static_cast<size_t>(frame)] - times.front()) / duration;
  });
  candidate.priors = RigidMotionPriors();
  return candidate;
}

}  // namespace

NuisanceEntry RegistrationDriftNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
