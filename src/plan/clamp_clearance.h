// Clamps of a planned recording beside the planes of contact of the model.
#ifndef LACUNA_PLAN_CLAMP_CLEARANCE_H_
#define LACUNA_PLAN_CLAMP_CLEARANCE_H_

#include <vector>

#include "fem/model.h"
#include "geometry/tet_mesh.h"
#include "scan/recorded_grip.h"

namespace lacuna {

// The grips of a recording at the times, s, of its frames.
struct GripsOverTime {
  const std::vector<RecordedGrip>& grips;
  const std::vector<double>& times;
};

// A clamp cannot go where a plane of contact stands, unless it is as deep there in the recording
// that a plan changes, whose path or plane may be off by that much. Throws InputError, without a
// position, where a grip with a given path comes deeper behind a plane than it does in `recorded`,
// which has the same grips in the same order. `mesh` is the undeformed object.
void RequireClampAbovePlanes(const GripsOverTime& planned, const GripsOverTime& recorded,
                             const EffectList& effects, const TetMesh& mesh);

}  // namespace lacuna

#endif  // LACUNA_PLAN_CLAMP_CLEARANCE_H_
