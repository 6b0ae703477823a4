// The motion of a recording's first surface through all of its states, by CPD, once for all meshes.
//
// S_0 is registered to every S_k once, whatever is simulated; the displacement is a field over the
// undeformed space, and any mesh of S_0 reads its own vertices' places from it. What this leaves
// out: align(p, S) of Eq. 1 no longer depends on where the simulation is, so that it keeps what CPD
// is off along the surface, where alignment in the loop would slide along.
#ifndef LACUNA_RECONSTRUCTION_TRACKED_FRAMES_H_
#define LACUNA_RECONSTRUCTION_TRACKED_FRAMES_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/progress.h"
#include "experiment/frame_states.h"
#include "reconstruction/reconstruction_study.h"
#include "registration/displacement_field.h"

namespace lacuna {

struct TrackedFrames {
  Eigen::Matrix3Xd points;                // 3 × n, m: the vertices of S_0, a fixed sampling of it
  std::vector<DisplacementField> fields;  // from S_0 to each state; the first one is empty
  std::vector<std::string> warnings;      // registrations that did not settle

  // Displacements (3 × n, m) in state k of points of the undeformed body (3 × n, m).
  Eigen::Matrix3Xd DisplacementAt(size_t k, const Eigen::Matrix3Xd& at_rest) const;
  // Their standard deviations, n, m.
  Eigen::VectorXd DeviationAt(size_t k, const Eigen::Matrix3Xd& at_rest) const;
};

// Each registration starts from the one before. The states need points that stand for them
// (StatePoints), the first of which is S_0.
TrackedFrames TrackFrames(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                          Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_TRACKED_FRAMES_H_
