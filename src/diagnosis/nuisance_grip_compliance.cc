// A grip that yields to its force, or that ends elsewhere than in the model. A negative compliance
// stands for a grip that reaches further than the model's.
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "grip_compliance";
  card.title = "the compliance or the extent of a grip";
  card.directions =
      "each grip shifted against its force, and rotated against its moment, in proportion";
  card.prior = "1 mm and 0.02 rad at the largest force and moment";
  card.residual_when_present =
      "Natural frequencies are too high or too low, by a share that depends on the mode: as for a "
      "wrong stiffness near the grip.";
  card.advice = "check how far the clamp reaches and whether it yields or slips";
  card.source = NuisanceSource::kGrip;
  card.outgrows_first_order = true;
  card.trial.limits_detection = true;
  card.trial.control = "grip";
  card.trial.control_position = 1;
  card.trial.least_clamp_error = 1e-3;
  card.trial.largest_clamp_error = 2e-3;
  return card;
}

NuisanceCandidate Make(const GripMotions::Grip& grip, const Eigen::MatrixXd& grip_columns) {
  NuisanceCandidate candidate;
  candidate.what = "the compliance or the extent of " + grip.label;
  candidate.columns = grip_columns.middleCols(grip.yielding, 2);
  const auto prior = [](double deviation, double largest) {
    return LinearPrior{0, largest > 0 ? deviation / largest : deviation, false};
  };
  candidate.priors = {prior(kThresholds.nuisances.shift, grip.force->Value()),
                      prior(kThresholds.nuisances.rotation, grip.moment->Value())};
  return candidate;
}

}  // namespace

NuisanceEntry GripComplianceNuisance() { return {Card(), &Make}; }

}  // namespace lacuna
