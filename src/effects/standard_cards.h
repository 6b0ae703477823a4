// The cards of effects that other finite-element programs know too, by which other modules refer to
// them without spelling their names. Gravity, stiffness-proportional damping and the neo-Hookean
// law have headers of their own. Laws, sources and units are in the .cc file of each effect.
#ifndef LACUNA_EFFECTS_STANDARD_CARDS_H_
#define LACUNA_EFFECTS_STANDARD_CARDS_H_

#include "record/effect_card.h"

namespace lacuna {

// Elasticity laws. Parameters: young_modulus (Pa) and poisson_ratio.
const EffectCard& LinearElasticityCard();
const EffectCard& CorotationalElasticityCard();
const EffectCard& SaintVenantKirchhoffCard();

// Parameter: alpha (1/s).
const EffectCard& MassDampingCard();

// Parameters: modulus (Pa), relaxation_time (s), and the setting poisson_ratio.
const EffectCard& ViscoelasticBranchCard();

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_STANDARD_CARDS_H_
