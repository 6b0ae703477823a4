#include "diagnosis/scored_effect.h"

namespace lacuna {

AdoptedNuisances AdoptedNuisances::Always() const {
  return {columns.leftCols(always), {priors.begin(), priors.begin() + always}, always};
}

AdoptedNuisances AdoptedNuisances::And(const NuisanceCandidate& nuisance) const {
  AdoptedNuisances with = *this;
  AppendColumns(nuisance.columns, nuisance.priors, &with.columns, &with.priors);
  return with;
}

}  // namespace lacuna
