// The card of the neo-Hookean elasticity law, by which other modules refer to the law without
// spelling its name. The energy and its source are in neo_hookean_energy.h.
#ifndef LACUNA_EFFECTS_NEO_HOOKEAN_H_
#define LACUNA_EFFECTS_NEO_HOOKEAN_H_

#include "record/effect_card.h"

namespace lacuna {

// Parameters: young_modulus (Pa) and poisson_ratio, both at small strain.
const EffectCard& NeoHookeanCard();

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_NEO_HOOKEAN_H_
