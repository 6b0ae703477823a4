// The basis of the unknown external forces that a reconstruction fits.
#ifndef LACUNA_RECONSTRUCTION_FORCE_MODEL_CHOICE_H_
#define LACUNA_RECONSTRUCTION_FORCE_MODEL_CHOICE_H_

#include "fem/model.h"
#include "fit/force_model.h"
#include "reconstruction/reconstruction_study.h"

namespace lacuna {

// The force model that the settings describe. It acts on the boundary nodes of the region except
// those that a grip holds, where a force has no effect. Throws InputError when no node is left, or
// no combination of forces without net force and torque where that is asked for.
ForceModel MakeForceModel(const ReconstructionStudy& study, const Model& grips_and_body);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_FORCE_MODEL_CHOICE_H_
