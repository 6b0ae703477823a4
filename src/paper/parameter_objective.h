// The objective of the paper: how well a body with the parameters (q, v, y, p) follows a recording,
//
//   P(q, v, y, p) = |D_anim| = Σ_k |D_k|                   (Transue & Choi 2015, Eq. 2, section 8).
//
// TetGen meshes S_0 with the quality q and the maximal volume v; the body has Young's modulus y and
// Poisson's ratio p and follows the frames under forces that are fitted in each frame.
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

// The four parameters of the search, SI.
struct SearchedParameters {
  double radius_edge_ratio = 2;  // q
  double max_volume = 0;         // v, m³
  double young_modulus = 0;      // y, Pa
  double poisson_ratio = 0;      // p
};

// Everything that is the same in all evaluations of a search. The members must outlive it.
struct ParameterObjective {
  const ReconstructionStudy& study;  // whose mesh settings and moduli are replaced
  const std::vector<FrameState>& states;
  const TrackedFrames& tracked;  // its points are the fixed sampling of the surface
  // Whether S_0 is remeshed to triangles of the size of the faces of a regular tetrahedron of
  // volume v, so that v determines the size of the mesh at its surface too. Otherwise TetGen
  // receives S_0 as it was reconstructed and splits its triangles as v and q require
  // (mesh.preserve_surface).
  bool remesh_surface = true;
  bool registration_in_loop = false;  // register each simulated surface by CPD, as in the paper
  // S_0 is rotated by this angle, rad, about an oblique axis for TetGen, and the mesh is rotated
  // back: another mesh of the same quality.
  double turn = 0;
  // Whether the derivatives by y and p are computed too, where they exist (CanDifferentiate).
  bool slopes = false;
};

// The measures of D, or their derivatives by one parameter.
struct ObjectiveSlope {
  double residual_sum = kNotMeasured, residual_per_point = kNotMeasured,
         residual_rms = kNotMeasured;
};

// The result of one evaluation of the objective.
struct ObjectiveEvaluation {
  bool usable = false;
  // One line: TetGen failed, a frame could not be followed, or its registration failed, so that its
  // D was not measured.
  std::string failure;
  // |D_anim|, m, over the vertices of the simulated surface, whose number depends on q and v.
  double residual_sum = kNotMeasured;
  // The mean length of the residual over the frames and a fixed sampling of the surface, m. With
  // registration in the loop, D is interpolated linearly between the vertices.
  double residual_per_point = kNotMeasured;
  double residual_rms = kNotMeasured;   // rms of these residuals, m
  double scan_distance = kNotMeasured;  // mean distance of scan points, m, without correspondences
  double force = kNotMeasured;          // mean length of the net force over the frames, N
  int nodes = 0, tets = 0, surface_points = 0;
  // ∂/∂y (per Pa) and ∂/∂p of the measures; empty where they were not requested or do not exist.
  std::vector<ObjectiveSlope> by_moduli;
  double seconds = 0;  // wall time, the only number here that is not reproducible
};

// Whether derivatives by y and p exist: neither with CPD in the loop nor with fitted forces
// (reconstruction/followed_sensitivity.h).
bool CanDifferentiate(const ParameterObjective& problem);
// The steps of an evaluation: the body (InputError where TetGen fails), its motion (which ends
// before the first frame that cannot be followed) and the measures without the time.
ReferenceBody MakeObjectiveBody(const ParameterObjective& problem,
                                const SearchedParameters& parameters);
FollowedMotion FollowForObjective(const ParameterObjective& problem,
                                  const SearchedParameters& parameters,
                                  const ReferenceBody& reference);
ObjectiveEvaluation MeasureObjective(const ParameterObjective& problem,
                                     const FollowedMotion& motion);

// All three steps. Throws Interrupted, and OutOfMemory (core/memory_limit.h) or std::bad_alloc, as
// what does not fit into this machine's memory is no property of the parameters. The evaluation
// reports every other failure.
ObjectiveEvaluation EvaluateObjective(const ParameterObjective& problem,
                                      const SearchedParameters& parameters);

}  // namespace lacuna

#endif  // LACUNA_PAPER_PARAMETER_OBJECTIVE_H_
