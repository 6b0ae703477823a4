// A made-up ledger: a bar whose model lacks drag, before and after drag was added.
#ifndef LACUNA_SUPPORT_SMALL_LEDGER_H_
#define LACUNA_SUPPORT_SMALL_LEDGER_H_

#include "record/ledger.h"

namespace lacuna {

// The first model has an error of 4 σ; its diagnosis refitted drag and mass damping and names drag.
// The second one, with drag, has 2 σ. The search ended because that is less than a gain of 60 %.
Ledger SmallLedger();

}  // namespace lacuna

#endif  // LACUNA_SUPPORT_SMALL_LEDGER_H_
