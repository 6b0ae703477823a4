// Stages 3, 5 and 6 of Transue & Choi 2015: the states are registered, and forces are fitted that
// make the simulated body follow them.
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

// One frame of the followed motion. Matrices are 3 × nodes unless stated otherwise.
struct FollowedFrame {
  double time = 0;            // s
  Eigen::Matrix3Xd position;  // m, the simulated nodes under `force`
  Eigen::Matrix3Xd force;     // N, the external forces, fitted or known
  // Standard deviation of the resultant of the fitted forces, N; NaN where the forces are not
  // coefficients of a basis.
  Eigen::Vector3d force_deviation = Eigen::Vector3d::Constant(kNotMeasured);
  // The initial guess of the paper, m α in N, with v = d/dt and α = dv/dt from the registered
  // displacements, and with m the masses of the nodes or 1 kg.
  Eigen::Matrix3Xd pseudo_force;
  // D of Eq. 1 after the step, m: align(p, S) − p, from each boundary vertex to its place in the
  // state (3 × boundary vertices). Where tracked points identify themselves (HasIdentifiedPoints)
  // no alignment is needed: from the place of each on the model to where it was seen (3 × tracked
  // points; NaN where it was not, and for a point whose place on the model is not known).
  Eigen::Matrix3Xd residual;
  // Why D was not measured, in which case all of it is NaN: the registration failed, or no tracked
  // point was seen. Empty where it was measured, and in a frame that was not followed.
  std::string residual_problem;
  double weighted_rms = 0;  // rms of the observations' residuals, each divided by its σ
  int observations = 0;
  // dx/dθ for the requested moduli (3·nodes × moduli). It is not kept in files, and empty where it
  // was not requested or does not exist (followed_sensitivity.h).
  Eigen::MatrixXd position_derivative;
  SolverStatus solver;
};

struct FollowedMotion {
  std::shared_ptr<const Body> body;
  // m, the σ that the fit used, of a scanned point or of a coordinate of an identified one; NaN
  // where no forces were fitted.
  double noise = kNotMeasured;
  std::vector<FollowedFrame> frames;  // ends before the first frame that could not be followed
  std::vector<std::string> warnings;
};

// Simulates the body from frame to frame. Each frame takes three steps: register the simulated
// surface to the next state by CPD, fit the forces to the registered displacements and the scanned
// points (Eq. 1), and advance the body under them. `tracked` holds registrations of the same states
// that replace CPD, for scans whose first frame is the reference shape (CHECK). `moduli` lists the
// parameters of the first effect by which the motion is differentiated. They require `tracked` and
// no fitted forces (CHECK), because correspondences have no derivative. Throws InputError and
// Interrupted; a frame that cannot be followed ends the motion.
FollowedMotion FollowFrames(const ReconstructionStudy& study, const ReferenceBody& reference,
                            const std::vector<FrameState>& states, Progress* progress,
                            const TrackedFrames* tracked = nullptr,
                            const std::vector<int>& moduli = {});

// What is wrong with a model whose surface lies far from the points (3 × n, m) that it was fitted
// to: half of them are farther away than kFarFromScan times its size. Points beyond the reach of
// the fit do not count in it, so that it may converge while it sees next to nothing. Empty
// otherwise.
std::string FarFromScan(const TriMesh& surface, const Eigen::Matrix3Xd& points);

void WriteFollowedMotion(const FollowedMotion& motion, const std::filesystem::path& folder);
FollowedMotion ReadFollowedMotion(const ReconstructionStudy& study, const ReferenceBody& reference,
                                  const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_FOLLOW_H_
