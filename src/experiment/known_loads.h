// The measured forces of a recording, as external loads on the body.
#ifndef LACUNA_EXPERIMENT_KNOWN_LOADS_H_
#define LACUNA_EXPERIMENT_KNOWN_LOADS_H_

#include <memory>
#include <vector>

#include "fem/model.h"
#include "scan/recording.h"

namespace lacuna {

// One load for each measured force of the recording, spread over the boundary nodes of its region.
// Throws InputError when a region contains no boundary node, or only nodes that a grip holds, where
// the force has no effect.
EffectList MakeKnownForces(const Recording& recording, const Model& grips_and_body);

}  // namespace lacuna

#endif  // LACUNA_EXPERIMENT_KNOWN_LOADS_H_
