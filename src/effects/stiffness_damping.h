// The card of stiffness-proportional damping, by which other modules refer to the effect without
// spelling its name. The law and its source are in stiffness_damping.cc.
#ifndef LACUNA_EFFECTS_STIFFNESS_DAMPING_H_
#define LACUNA_EFFECTS_STIFFNESS_DAMPING_H_

#include "record/effect_card.h"

namespace lacuna {

// Parameters: beta (s), and the setting of the elasticity that it refers to, young_modulus (Pa) and
// poisson_ratio.
const EffectCard& StiffnessDampingCard();

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_STIFFNESS_DAMPING_H_
