// The neo-Hookean elasticity law as code outside this module needs it: its card, so that the law is
// referred to without its name. The energy and its source stand in neo_hookean_energy.h.
#ifndef LACUNA_EFFECTS_NEO_HOOKEAN_H_
#define LACUNA_EFFECTS_NEO_HOOKEAN_H_

#include "record/effect_card.h"

namespace lacuna {

// Parameters: young_modulus (Pa) and poisson_ratio, both at small strain.
const EffectCard& NeoHookeanCard();

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_NEO_HOOKEAN_H_
