// Stiffness-proportional damping as code outside this module needs it: its card, so that the effect
// is referred to without its name. The law and its source stand in stiffness_damping.cc.
#ifndef LACUNA_EFFECTS_STIFFNESS_DAMPING_H_
#define LACUNA_EFFECTS_STIFFNESS_DAMPING_H_

#include "record/effect_card.h"

namespace lacuna {

// Parameters: beta (s), and the setting of the elasticity that it refers to, young_modulus (Pa) and
// poisson_ratio.
const EffectCard& StiffnessDampingCard();

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_STIFFNESS_DAMPING_H_
