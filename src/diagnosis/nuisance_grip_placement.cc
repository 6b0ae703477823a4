// A grip that holds the object elsewhere, or at another angle, than the recording says.
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "grip_placement";
  card.title = "the placement of a grip";
  card.directions = "each grip shifted along three axes and rotated about three axes";
  card.prior = "1 mm and 0.02 rad";
  card.residual_when_present =
      "The whole object is displaced like a rigid body that hangs on the grip, in all frames.";
  card.advice = "measure where the grip holds the object, or fit it";
  card.source = NuisanceSource::kGrip;
  card.trial.limits_detection = true;
  return card;
}

NuisanceCandidate Make(const GripMotions::Grip& grip, const Eigen::MatrixXd& grip_columns) {
  NuisanceCandidate candidate;
  candidate.what = "the placement of " + grip.label;
  candidate.columns = grip_columns.middleCols(grip.rigid, 6);
  candidate.priors = RigidMotionPriors();
  return candidate;
}

}  // namespace

NuisanceEntry GripPlacementNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
