// A grip that yields to its force. A negative compliance stands for a model whose object yields too
// much near the grip.
#include "diagnosis/nuisance_catalogue.h"
#include "diagnosis/thresholds.h"

namespace lacuna {
namespace {

NuisanceCard Card() {
  NuisanceCard card;
  card.name = "grip_compliance";
  card.title = "the compliance of a grip";
  card.directions =
      "each grip shifted against its force, and rotated against its moment, in proportion";
  card.prior = "1 mm and 0.02 rad at the largest force and moment";
  card.residual_when_present =
      "Natural frequencies are too high or too low, by a share that depends on the mode: as for a "
      "wrong stiffness near the grip.";
  card.advice = "check whether the clamp yields or slips";
  card.source = NuisanceSource::kGrip;
  card.outgrows_first_order = true;
  card.trial.limits_detection = true;
  return card;
}

NuisanceCandidate Make(const GripMotions::Grip& grip, const Eigen::MatrixXd& grip_columns) {
  NuisanceCandidate candidate;
  candidate.what = "the compliance of " + grip.label;
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
