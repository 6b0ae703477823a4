// The recorded side of a reconstruction: the state of the object in every frame, and the undeformed
// body that is made from the first of them or from a given shape.
#ifndef LACUNA_RECONSTRUCTION_RECORDED_STATES_H_
#define LACUNA_RECONSTRUCTION_RECORDED_STATES_H_

#include <string>
#include <vector>

#include "core/progress.h"
#include "experiment/frame_states.h"
#include "experiment/reference_body.h"
#include "reconstruction/reconstruction_study.h"

namespace lacuna {

// One state per frame of the study, in the same order. Throws InputError, which names the frame,
// and Interrupted.
std::vector<FrameState> LoadFrameStates(const ReconstructionStudy& study, Progress* progress);

// `first` is the state of the study's first frame. Throws InputError when the shape cannot be
// meshed.
ReferenceBody MakeReferenceBody(const ReconstructionStudy& study, const FrameState& first);

// Whether the first frame is the reference shape itself, so that it need not be followed.
bool FirstFrameIsReference(const ReconstructionStudy& study);

// Whether the states hold tracked points that identify themselves, so that no registration is
// needed to know where a point of the body is.
bool HasIdentifiedPoints(const ReconstructionStudy& study, const std::vector<FrameState>& states);

// Where tracked points are on the undeformed body, 3 × n, m; NaN where that is not known.
struct PlacesAtRest {
  Eigen::Matrix3Xd tracked;   // of FrameState::tracked
  Eigen::Matrix3Xd held_out;  // of FrameState::held_out
};
// The `marker_places` of the recording. A point without such a place is taken to be where the first
// state shows it, in which the body must be undeformed then.
PlacesAtRest FindPlacesAtRest(const ReconstructionStudy& study,
                              const std::vector<FrameState>& states);

// The notes of the states as warnings that name the frame. Notes that differ in their numbers only
// become one warning, which says how many other frames have such a note, and up to which; those
// that the recording's own warnings contain are left out.
std::vector<std::string> WarningsOfStates(const ReconstructionStudy& study,
                                          const std::vector<FrameState>& states);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_RECORDED_STATES_H_
