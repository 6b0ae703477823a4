// Stages 3, 5 and 6 of the paper: registered states, the simulated body, and the forces that make
// the one follow the other.
#ifndef LACUNA_RECONSTRUCTION_FOLLOW_H_
#define LACUNA_RECONSTRUCTION_FOLLOW_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "core/progress.h"
#include "experiment/frame_states.h"
#include "experiment/reference_body.h"
#include "fem/model.h"
#include "reconstruction/reconstruction_study.h"
#include "reconstruction/tracked_frames.h"

namespace lacuna {

// One frame, followed. Vectors are 3 × nodes.
struct FollowedFrame {
  double time = 0;            // s
  Eigen::Matrix3Xd position;  // m, the simulated nodes under `force`
  Eigen::Matrix3Xd force;     // N, the outer forces, fitted or known
  // Of the fitted forces' resultant, N; NaN where they are no coefficients of a basis.
  Eigen::Vector3d force_deviation = Eigen::Vector3d::Constant(kNotMeasured);
  // The paper's first guess of the forces, m α with v = d/dt and α = dv/dt from the registered
  // displacements, m the nodes' masses or 1 kg.
  Eigen::Matrix3Xd pseudo_force;
  // align(p, S) − p of Eq. 1: from each boundary vertex to where the state has it, after the step.
  Eigen::Matrix3Xd residual;  // 3 × boundary vertices, m
  double weighted_rms = 0;    // of the observations, in their standard deviations
  int observations = 0;
  // dx/dθ of the moduli asked for (3·nodes × moduli); not kept in files. Empty: not asked for,
  // or not to be had (reconstruction/followed_sensitivity.h).
  Eigen::MatrixXd position_by;
  SolverStatus solver;
};

struct FollowedMotion {
  std::shared_ptr<const Body> body;
  double noise = 0;                   // m, the standard deviation of a scanned point that was used
  std::vector<FollowedFrame> frames;  // ends at the first frame that could not be followed
  std::vector<std::string> warnings;
};

// Simulates the body from frame to frame. In each: register the simulated surface to the next state
// by CPD, fit the forces to the registered displacements and the scanned points (Eq. 1), and take
// the step under them. `tracked`: registrations of the same states, taken in place of CPD; only for
// scans whose first frame is the reference shape (CHECK). `moduli`: parameters of the first effect
// by which to differentiate the motion; only with `tracked` and without fitted forces (CHECK):
// correspondences have no derivative.
FollowedMotion FollowFrames(const ReconstructionStudy& study, const ReferenceBody& reference,
                            const std::vector<FrameState>& states, Progress* progress,
                            const TrackedFrames* tracked = nullptr,
                            const std::vector<int>& moduli = {});

void SaveFollowedMotion(const FollowedMotion& motion, const std::filesystem::path& folder);
FollowedMotion ReadFollowedMotion(const ReconstructionStudy& study, const ReferenceBody& reference,
                                  const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_FOLLOW_H_
