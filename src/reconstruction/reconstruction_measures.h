// Stage 7 of the paper: how well the model follows, and the files that show it.
#ifndef LACUNA_RECONSTRUCTION_RECONSTRUCTION_MEASURES_H_
#define LACUNA_RECONSTRUCTION_RECONSTRUCTION_MEASURES_H_

#include <filesystem>
#include <string>
#include <vector>

#include "experiment/frame_states.h"
#include "experiment/reference_body.h"
#include "reconstruction/follow.h"
#include "reconstruction/reconstruction_study.h"
#include "record/run_record.h"

namespace lacuna {

// |D| (Eq. 1) and distances of every frame, |D_anim| (Eq. 2), held-out points and known truths
// where the study names them. Measures beside the frames' own, in RunRecord::measures:
//   noise_m                        of a scanned point, as used
//   residual_per_point_m           mean of |D| per point over the frames
//   surface_distance_mean_m        mean over the frames after the reference
//   held_out_rms_max_m             the worst frame's RMS error of the held-out points
//   held_out_spacing_m             their mean distance to the nearest other tracked point
//   true_surface_distance_mean_m   of the true surface's vertices from the simulated surface, all
//                                  frames after the reference together; ..._max_m the worst frame's
//   true_position_mean_error       mean error of the true points over the largest displacement
//   true_force_median_error        median over the frames of |F − F_true| / |F_true|
RunRecord MeasureRun(const ReconstructionStudy& study, const ReferenceBody& reference,
                     const std::vector<FrameState>& states, const FollowedMotion& motion);

// body.pvd with the nodes' displacement_m and force_N; surface.pvd with the boundary's residual_m
// and distance to the scan; scan.pvd with the points and their distance to the model.
void WriteFields(const ReconstructionStudy& study, const std::vector<FrameState>& states,
                 const FollowedMotion& motion, const RunRecord& record,
                 const std::filesystem::path& folder);

}  // namespace lacuna

#endif  // LACUNA_RECONSTRUCTION_RECONSTRUCTION_MEASURES_H_
