// The full description of a nuisance, for example `lacuna explain time_jitter`.
#ifndef LACUNA_APP_EXPLAIN_NUISANCE_H_
#define LACUNA_APP_EXPLAIN_NUISANCE_H_

#include "diagnosis/nuisance.h"

namespace lacuna {

// Prints the card to the standard output. Returns the exit status.
int ExplainNuisance(const NuisanceCard& card);

}  // namespace lacuna

#endif  // LACUNA_APP_EXPLAIN_NUISANCE_H_
