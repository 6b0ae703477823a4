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
  Eigen::Matrix3Xd points;  // 3 × n, m: the vertices of S_0
  // From S_0 to each state. Empty for S_0 itself and where the registration failed.
  std::vector<DisplacementField> fields;
  std::vector<std::string> failures;  // one per state: why its field is missing; empty: it is not
  std::vector<std::string> warnings;  // about registrations that failed or did not converge

  // The displacements (3 × n, m) in state k of points of the undeformed body (3 × n, m). Where the
  // registration failed, those of the last state before it whose did not: a place to start from.
  Eigen::Matrix3Xd DisplacementAt(size_t k, const Eigen::Matrix3Xd& at_rest) const;
  // Their standard deviations, n, m: 0 in S_0, infinite where the registration failed.
  Eigen::VectorXd DeviationAt(size_t k, const Eigen::Matrix3Xd& at_rest) const;
};

// Each registration starts from the last result before it. The first of the states, represented by
// its StatePoints, is S_0. The warnings are logged, too, because an outer search follows the same
// fields hundreds of times and does not report the warnings of its motions. Throws Interrupted.
TrackedFrames TrackFrames(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                          Progress* progress);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_TRACKED_FRAMES_H_
