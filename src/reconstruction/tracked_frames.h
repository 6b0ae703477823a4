// The motion of a recording's first surface through all of its states, found by CPD once for all
// meshes.
//
// S_0 is registered to every S_k once, independent of any simulation. The displacement is a field
// over the undeformed space, at which the vertices of any mesh of S_0 can be evaluated. In
// contrast to registration in the loop, align(p, S) of Eq. 1 does not depend on the simulated
// shape, so that it retains the error of CPD along the surface.
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
  Eigen::Matrix3Xd points;                // 3 × n, m: the vertices of S_0
  std::vector<DisplacementField> fields;  // from S_0 to each state; the first one is empty
  std::vector<std::string> warnings;      // registrations that did not converge

  // The displacements (3 × n, m) in state k of points of the undeformed body (3 × n, m).
  Eigen::Matrix3Xd DisplacementAt(size_t k, const Eigen::Matrix3Xd& at_rest) const;
  // Their standard deviations, n, m.
  Eigen::VectorXd DeviationAt(size_t k, const Eigen::Matrix3Xd& at_rest) const;
};

// Each registration starts from the result of the previous one. The first of the states,
// represented by its StatePoints, is S_0. Throws InputError where a state has no points, and
// Interrupted.
TrackedFrames TrackFrames(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                          Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_TRACKED_FRAMES_H_
