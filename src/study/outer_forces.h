// The forces from outside that a study knows of or looks for.
#ifndef LACUNA_STUDY_OUTER_FORCES_H_
#define LACUNA_STUDY_OUTER_FORCES_H_

#include <memory>
#include <vector>

#include "fem/model.h"
#include "fit/force_model.h"
#include "study/reconstruction.h"

namespace lacuna {

// The force model that the settings describe: on boundary nodes of the region that no grip holds,
// where a force would move nothing. Throws InputError when there is no such node.
ForceModel MakeForceModel(const ReconstructionStudy& study, const Model& grips_and_body);

// The recording's measured forces as loads on the boundary nodes of their regions. Throws
// InputError when a region holds no boundary node, or only nodes that a grip holds, where the force
// would move nothing.
std::vector<std::shared_ptr<Effect>> MakeKnownForces(const Recording& recording,
                                                     const Model& grips_and_body);

}  // namespace lacuna

#endif  // LACUNA_STUDY_OUTER_FORCES_H_
