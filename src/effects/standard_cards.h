// The cards of effects that other finite-element programs know too, by which other modules refer to
// them without spelling their names. (Gravity has a header of its own.) Laws, sources and units are
// in the .cc file of each effect.
#ifndef LACUNA_EFFECTS_STANDARD_CARDS_H_
#define LACUNA_EFFECTS_STANDARD_CARDS_H_

#include "record/effect_card.h"

namespace lacuna {

// Elasticity laws. Parameters: young_modulus (Pa) and poisson_ratio, both at small strain.
const EffectCard& LinearElasticityCard();
const EffectCard& CorotationalElasticityCard();
const EffectCard& SaintVenantKirchhoffCard();
const EffectCard& NeoHookeanCard();

// Parameter: alpha (1/s).
const EffectCard& MassDampingCard();

// Parameters: beta (s), and young_modulus (Pa) and poisson_ratio of the stiffness to which beta
// refers. The moduli are parameters with derivatives, not settings, because a fit changes them
// together with those of the material (stiffness_damping.cc).
const EffectCard& StiffnessDampingCard();

// Parameters: modulus (Pa), relaxation_time (s), and the setting poisson_ratio.
const EffectCard& ViscoelasticBranchCard();

}  // namespace lacuna

#endif  // LACUNA_EFFECTS_STANDARD_CARDS_H_
