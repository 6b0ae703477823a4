// The paper's objective: how well a body with the parameters (q, v, y, p) can follow a recording.
//
//   P(q, v, y, p) = |D_anim| = Σ_k |D_k|                   (Transue & Choi 2015, Eq. 2, section 8)
//
// of the body that TetGen makes of S_0 with q and v, has the moduli y and p, and follows the frames
// under forces fitted anew in each.
#ifndef LACUNA_PAPER_PARAMETER_OBJECTIVE_H_
#define LACUNA_PAPER_PARAMETER_OBJECTIVE_H_

#include <Eigen/Core>
#include <string>
#include <vector>

#include "experiment/frame_states.h"
#include "experiment/reference_body.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_study.h"
#include "reconstruction/tracked_frames.h"
#include "record/run_record.h"

namespace lacuna {

struct OuterParameters {
  double radius_edge_ratio = 2;  // q
  double max_volume = 0;         // v, m³
  double young_modulus = 0;      // y, Pa
  double poisson_ratio = 0;      // p
};

// What stays the same in all evaluations of a search. The members must outlive it.
struct OuterProblem {
  const ReconstructionStudy& study;  // but for the four parameters
  const std::vector<FrameState>& states;
  const TrackedFrames& tracked;  // its points are the fixed sampling of the surface
  // S_0 is remeshed to triangles as large as the faces of a regular tetrahedron of volume v before
  // TetGen keeps them, so that v decides the size of the mesh at its surface, too. Otherwise TetGen
  // gets S_0 as it was reconstructed, and splits what v and q ask for (mesh.preserve_surface).
  bool remesh_surface = true;
  bool registration_in_loop = false;  // CPD of each simulated surface, as in the paper
  // S_0 is turned by this angle about an oblique axis before TetGen sees it, and its mesh turned
  // back, rad: another mesh of the same quality.
  double turn = 0;
  // Also differentiate by y and p, where that can be done (CanDifferentiate).
  bool slopes = false;
};

// What is measured of D, or its derivative by one parameter.
struct OuterSlope {
  double residual_sum = kNotMeasured, residual_per_point = kNotMeasured,
         residual_rms = kNotMeasured;
};

struct OuterEvaluation {
  bool usable = false;
  std::string failure;  // one line: TetGen refused, or which frame could not be followed
  // |D_anim|, m: over the vertices of the simulated surface, whose number changes with q and v.
  double residual_sum = kNotMeasured;
  // The residual's mean over the frames and the fixed sampling, m. D there comes from the tracked
  // points themselves, or, with registration in the loop, by linear interpolation between vertices.
  double residual_per_point = kNotMeasured;
  double residual_rms = kNotMeasured;   // the root of the mean square of the same lengths, m
  double scan_distance = kNotMeasured;  // mean over scan points and frames, m; no correspondence
  double force = kNotMeasured;          // mean over the frames of the net force's length, N
  int nodes = 0, tets = 0, surface_points = 0;
  // ∂/∂y (per Pa) and ∂/∂p of what is above; empty: not asked for, or not to be had.
  std::vector<OuterSlope> by_moduli;
  double seconds = 0;  // wall time; the one number here that is not repeatable
};

// Whether y and p have derivatives here: not with CPD in the loop, nor with fitted forces
// (reconstruction/followed_sensitivity.h).
bool CanDifferentiate(const OuterProblem& problem);
// The steps of an evaluation: the body, which is an InputError where TetGen refuses; how it follows
// the frames, ending at the first one where it cannot; and what that measures but the time.
ReferenceBody MakeOuterBody(const OuterProblem& problem, const OuterParameters& parameters);
FollowedMotion FollowOuter(const OuterProblem& problem, const OuterParameters& parameters,
                           const ReferenceBody& reference);
OuterEvaluation MeasureOuter(const OuterProblem& problem, const FollowedMotion& motion);

// Throws Interrupted; whatever else goes wrong with these parameters is a failed evaluation.
OuterEvaluation EvaluateOuter(const OuterProblem& problem, const OuterParameters& parameters);

}  // namespace lacuna

#endif  // LACUNA_PAPER_PARAMETER_OBJECTIVE_H_
