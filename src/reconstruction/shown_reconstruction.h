// What a report shows of a reconstruction: the simulated surface and the scanned points over time.
#ifndef LACUNA_RECONSTRUCTION_SHOWN_RECONSTRUCTION_H_
#define LACUNA_RECONSTRUCTION_SHOWN_RECONSTRUCTION_H_

#include <vector>

#include "experiment/frame_states.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_study.h"
#include "record/motion_record.h"

namespace lacuna {

// The frames that could be followed, evenly thinned to kMostShownFrames: the surface with the
// fields residual (the length of D, Eq. 1, as ResidualAtVertices gives it; absent where no frame
// has it), displacement and force at a node, and the scanned points. At least one frame must have
// been followed (CHECK).
MotionRecord ShownReconstruction(const ReconstructionStudy& study,
                                 const std::vector<FrameState>& states,
                                 const FollowedMotion& motion);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_SHOWN_RECONSTRUCTION_H_
